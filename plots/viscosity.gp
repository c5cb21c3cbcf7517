# Two wisps that start in each other, at two viscosities (thesis, figure 5.3 and table 5.3).
STORY = 'Two wisps that start in each other'
NAMES = '"overlap"'
UNITS = '"points"'
WHAT = 'nodes and samples inside the other wisp; none: they have parted'
BODIES = 0
CLOUD = 0.35; EDGE = '#3A87B5'; SKELETON = 1.8
load plots.'/hair.gp'
