# What an implicit method's settings cost and buy.
WHAT = 'What solver settings cost and buy'
load plots.'/race.gp'
