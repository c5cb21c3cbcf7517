# Two wisps that meet, with and without subdivision (thesis, figure 5.5 and table 5.4).
STORY = 'Two wisps that meet, and may split'
NAMES = '"wisps" "strain"'
UNITS = '"-" "%"'
WHAT = 'number of wisps; largest strain of a spring'
BODIES = 0
CLOUD = 0.35; EDGE = '#3A87B5'; SKELETON = 1.8
load plots.'/hair.gp'
