load plots.'/style.gp'
