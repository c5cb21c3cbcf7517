# A head that is turned left and right.
STORY = 'A head turns left and right'
NAMES = '"head" "hair" "apart"'
UNITS = '"deg" "deg" "deg"'
WHAT = 'angle of the head, and of the hair by its tips, about the axis of the turn; how far they are apart'
load plots.'/hair.gp'
