# Two wisps that meet, with each response (thesis, figure 5.2 and table 5.2).
STORY = 'Two wisps that meet'
NAMES = '"crossings" "overlap"'
UNITS = '"-" "points"'
WHAT = 'skeletons that have passed through each other; nodes and samples inside the other wisp'
BODIES = 0
CLOUD = 0.35; EDGE = '#3A87B5'; SKELETON = 1.8
load plots.'/hair.gp'
