# What accuracy costs, by stepper.
WHAT = 'What accuracy costs'
load plots.'/race.gp'
