# Nine wisps of three radii in irregular wind (thesis, figure 5.1 and table 5.1).
STORY = 'Wisps of three radii in irregular wind'
NAMES = '"largest" "mean"'
UNITS = '"deg" "deg"'
WHAT = 'inclination of the wisps, root to tip, from the vertical'
load plots.'/hair.gp'
