# A head of hair in a gust (thesis, figure 5.6).
STORY = 'A gust lays hair over'
NAMES = '"downwind" "mean inclination" "largest inclination"'
UNITS = '"cm" "deg" "deg"'
WHAT = 'mean displacement of the tips; inclination of the wisps, root to tip, from the vertical'
load plots.'/hair.gp'
