# Two wisps that meet, with and without subdivision (thesis, figure 5.5 and table 5.4).
STORY = 'Two wisps that meet, and may split'
NAMES = '"wisps" "strain"'
UNITS = '"-" "%"'
WHAT = 'number of wisps; largest strain of a spring'
load plots.'/hair.gp'
