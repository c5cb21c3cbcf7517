# Two wisps that meet, with each response (thesis, figure 5.2 and table 5.2).
STORY = 'Two wisps that meet'
NAMES = '"crossings" "overlap"'
UNITS = '"-" "points"'
WHAT = 'skeletons that have passed through each other; nodes and samples inside the other wisp'
load plots.'/hair.gp'
