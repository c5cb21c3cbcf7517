load plots.'/style.gp'
eval require('rates series sources')
