# A head that is turned left and right.
STORY = 'A head turns left and right'
NAMES = '"head" "hair" "apart"'
UNITS = '"deg" "deg" "deg"'
WHAT = 'angle of the head, and of the hair by its tips, about the axis of the turn; how far they are apart'
BODIES = 2
CLOUD = 0.12; EDGE = '#A9D3EA'; SKELETON = 1
load plots.'/hair.gp'
