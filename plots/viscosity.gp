# Two wisps that start in each other, at two viscosities (thesis, figure 5.3 and table 5.3).
STORY = 'Two wisps that start in each other'
NAMES = '"overlap"'
UNITS = '"points"'
WHAT = 'nodes and samples inside the other wisp; none: they have parted'
load plots.'/hair.gp'
