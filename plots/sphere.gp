# A sphere through 36 wisps (thesis, figure 5.4).
STORY = 'A sphere moves through 36 wisps'
NAMES = '"points" "segments" "strain"'
UNITS = '"mm" "mm" "%"'
WHAT = 'how deep nodes and samples, and the lines between nodes, are in the sphere; largest strain of a spring'
BODIES = 1
CLOUD = 0.06; EDGE = "#C9E4F3"; SKELETON = 1.2
load plots.'/hair.gp'
