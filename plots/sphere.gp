# A sphere through 36 wisps (thesis, figure 5.4).
STORY = 'A sphere moves through 36 wisps'
NAMES = '"points" "segments" "strain"'
UNITS = '"mm" "mm" "%"'
WHAT = 'how deep nodes and samples, and the lines between nodes, are in the sphere; largest strain of a spring'
load plots.'/hair.gp'
