# The figures of the experiments of the thesis's chapter 5, from the tables of one of them. Its own
# script first sets
#   STORY = 'what is seen', and for the series NAMES = '"label" ...', UNITS = '"deg" ...' and WHAT they are
#   BODIES = 0 where there are none, 1 where the page must hold them, 2 where it holds the hair
#   CLOUD = 0 to 1, how dense envelopes are, EDGE = their '#colour', SKELETON = a line's width
load plots.'/style.gp'
eval require('table steppers series strip strip-cells')
larger(a, b) = a > b ? a : b

# Variants are no steppers: a colour, dash and mark for each, in their order.
set linetype 11 lc rgb '#000000' dt solid pt 7 ps 0.9 lw 1.7
set linetype 12 lc rgb '#E69F00' dt (12,4) pt 5 ps 0.9 lw 2
set linetype 13 lc rgb '#0072B2' dt (10,3,2,3) pt 9 ps 1.0 lw 1.7
set linetype 14 lc rgb '#D55E00' dt (4,3) pt 13 ps 1.0 lw 2
variants_here = ''
stats table('table') using (variants_here = strcol(1) eq 'variant' ? variants_here \
    : with_name(variants_here, strcol(1)), 0) nooutput
VARIANTS_HERE = words(variants_here)

# --- the frames that the thesis prints ---

CELLS = 0
array row_of[64]; array column_of[64]; array variant_of[64]; array frame_of[64]; array time_of[64]
rows = 0; columns = 0; first_row = 0
take(c) = (CELLS = c + 1, variant_of[c + 1] = strcol(4), frame_of[c + 1] = $5, time_of[c + 1] = $6, \
    column_of[c + 1] = $3, first_row = $3 == 0 && $2 == 0 ? rows : first_row, \
    row_of[c + 1] = first_row + $2, rows = larger(rows, row_of[c + 1] + 1), \
    columns = larger(columns, $3 + 1), 0)
stats table('strip-cells') using (strcol(1) eq 'cell' ? 0 : take(int($1)), 0) nooutput
LEAST_X = -1; MOST_X = 1; LEAST_Y = -1; MOST_Y = 1
if (CELLS) {
    stats table('strip') using ($3 > 0 || BODIES == 1 ? $1 : NaN):2 nooutput
    LEAST_X = STATS_min_x; MOST_X = STATS_max_x; LEAST_Y = STATS_min_y; MOST_Y = STATS_max_y
}
# Hair that lies along a line is given room across it.
ROOM_X = larger(0, 0.5 * (0.1 * (MOST_Y - LEAST_Y) - (MOST_X - LEAST_X)))
ROOM_Y = larger(0, 0.5 * (0.1 * (MOST_X - LEAST_X) - (MOST_Y - LEAST_Y)))
LEAST_X = LEAST_X - ROOM_X; MOST_X = MOST_X + ROOM_X; LEAST_Y = LEAST_Y - ROOM_Y; MOST_Y = MOST_Y + ROOM_Y
SPAN_X = 1.06 * (MOST_X - LEAST_X); SPAN_Y = 1.06 * (MOST_Y - LEAST_Y)
# The cells are as wide as the page allows, and at most 260 pixels high; no page is narrower than its
# heading.
LEFT = VARIANTS_HERE > 1 ? 44 : 16
CELL_WIDTH = (900. - LEFT - 16) / larger(columns, 1) - 8
CELL_HEIGHT = CELL_WIDTH * SPAN_Y / SPAN_X
if (CELL_HEIGHT > 260) { CELL_HEIGHT = 260.; CELL_WIDTH = larger(110, CELL_HEIGHT * SPAN_X / SPAN_Y) }
ROW_HEIGHT = CELL_HEIGHT + 30
eval figure('frames', larger(720, LEFT + 16 + columns * (CELL_WIDTH + 8)), \
    70 + larger(rows, 1) * ROW_HEIGHT + 26)
set linetype 21 lc rgb '#666666' dt solid lw 1.2
set linetype 22 lc rgb EDGE dt solid lw 1
set linetype 23 lc rgb '#C98A00' dt solid lw 1
set multiplot
eval heading(STORY, 'skeletons, outlines of envelopes' \
    .(BODIES ? ' and of bodies' : '').'; one scale; frames are counted from 1, 30 a second')
unset border; unset tics; unset grid
set size ratio -1
set xrange [LEAST_X - 0.03 * SPAN_X:MOST_X + 0.03 * SPAN_X]
set yrange [LEAST_Y - 0.03 * SPAN_Y:MOST_Y + 0.03 * SPAN_Y]
if (!CELLS) {
    eval panel(LEFT, 70, 400, 200)
    set label 3 'The run ends before the first of the frames that are drawn.' at graph 0, graph 0.5 left \
        textcolor rgb GREY
    plot @BLANK
}
do for [c = 1:CELLS] {
    eval panel(LEFT + (CELL_WIDTH + 8) * column_of[c], 92 + ROW_HEIGHT * row_of[c], CELL_WIDTH, CELL_HEIGHT)
    set object 1 rectangle from graph 0, graph 0 to graph 1, graph 1 behind fillstyle empty \
        border lc rgb '#D5D5D5'
    set label 3 sprintf('%d: %.2f s', frame_of[c], time_of[c]) at graph 0, graph 1 left offset 0.3, 0.7
    unset arrow; unset label 4; unset label 5
    if (VARIANTS_HERE > 1 && column_of[c] == 0) {
        set label 5 '{/:Bold '.escaped(variant_of[c]).'}' at graph 0, graph 0.5 center rotate by 90 \
            offset -2, 0
    }
    if (row_of[c] == rows - 1 && column_of[c] == 0) {
        set arrow 1 from graph 0, screen 13. / HEIGHT to graph 0.1 / SPAN_X, screen 13. / HEIGHT nohead \
            lc rgb '#000000' lw 2
        set label 4 '10 cm' at graph 0.1 / SPAN_X, screen 13. / HEIGHT left offset 0.7, 0 font ',11'
    }
    at = 5 * (c - 1)
    plot table('strip') index at using 1:2 with filledcurves closed lt 21 fc rgb '#BDBDBD' \
            fs transparent solid 0.6 noborder, \
         '' index at + 1 using 1:2 with filledcurves closed lt 22 fc rgb '#56B4E9' \
            fs transparent solid CLOUD border lt 22, \
         '' index at + 2 using 1:2 with filledcurves closed lt 23 fc rgb '#E69F00' \
            fs transparent solid CLOUD border lt 23, \
         '' index at using 1:2 with lines lt 21, \
         '' index at + 3 using 1:2 with lines lc rgb '#003F66' lw SKELETON dt solid, \
         '' index at + 4 using 1:2 with lines lc rgb '#8A2F00' lw SKELETON dt solid
    eval heading_done
}
unset multiplot

# --- what it costs ---

# columns of table.tsv and steppers.tsv
FAILED_AT = 3; CPU = 4; LEAST = 5; GREATEST = 6; RATIO = 7; THESIS = 10; THESIS_RATIO = 11
eval figure('cost', 900, 520)
eval names_of('steppers')
did(status) = status eq 'finished'
has_thesis = 0; has_failed = 0
stats table('table') using (has_thesis = column(THESIS) > 0 ? 1 : has_thesis, 0) nooutput
stats table('steppers') using (has_failed = place(names, strcol(1)) && !did(strcol(3)) ? 1 : has_failed, 0) \
    nooutput
set multiplot
eval heading('What it costs: '.STORY, \
    'thesis: explicit Euler at 9000 Hz, one MIPS R4400 at 200 MHz; ours: the same recipe, median, least to greatest')
place_of(name) = place(variants_here, name)
names_below = ''
do for [i = 1:VARIANTS_HERE] {
    names_below = names_below.sprintf("%s'%s' %d", i > 1 ? ', ' : '', word(variants_here, i), i)
}
set bars 0.7
if (VARIANTS_HERE > 1) {
    eval panel(70, 80, 375, 340)
    set xrange [0.5:VARIANTS_HERE + 0.5]
    stats table('table') using 9 nooutput
    highest = STATS_max
    if (has_thesis) { stats table('table') using THESIS_RATIO nooutput; highest = larger(highest, STATS_max) }
    set yrange [0:1.12 * highest]
    eval 'set xtics ('.names_below.') noenhanced font ",11"'
    set ylabel 'CPU time over the first row''s' offset 1, 0
    plot table('table') using (place_of(strcol(1)) - 0.1):RATIO:(column(8)):(column(9)) \
            with yerrorbars lc rgb '#000000' pt 7 ps 1 lw 1.5, \
         '' using (place_of(strcol(1)) + 0.1):THESIS_RATIO with points pt 6 ps 1.3 lw 2 lc rgb '#D55E00'
    eval heading_done
}
eval VARIANTS_HERE > 1 ? panel(640, 80, 235, 340) : panel(235, 80, 620, 340)
set autoscale
set ylabel ''
set xlabel 'CPU time (s per frame)' offset 0, 0.3
eval powers('x')
unset xtics; set xtics nomirror out scale 0.6 enhanced font ',13' offset 0, 0.3
row_count = VARIANTS_HERE + words(names) + 0.
set yrange [-row_count - 0.6:-0.4]
names_left = ''
do for [i = 1:VARIANTS_HERE] { names_left = names_left.sprintf("'%s' %d, ", word(variants_here, i), -i) }
do for [m = 1:words(names)] {
    setting = ''
    stats table('steppers') using (strcol(1) eq word(names, m) ? (setting = strcol(2), 0) : 0, 0) nooutput
    names_left = names_left.sprintf("'%s, %s' %g, ", word(names, m), setting, -VARIANTS_HERE - m)
}
eval 'set ytics ('.names_left[1:strlen(names_left) - 2].') noenhanced font ",11"'
set arrow 1 from first 1 / 30., graph 0 to first 1 / 30., graph 1 nohead lt 2
set label 3 'real time' at first 1 / 30., graph 1 center offset 0, 0.5 font ',11' textcolor rgb GREY
set arrow 2 from graph 0, first -VARIANTS_HERE - 0.5 to graph 1, first -VARIANTS_HERE - 0.5 nohead \
    lc rgb GREY lw 0.8
lowest = 1e300; highest = 1 / 30.
stats table('table') using (lowest = column(LEAST) < lowest ? column(LEAST) : lowest, \
    highest = larger(highest, larger(column(GREATEST), column(THESIS) > 0 ? column(THESIS) : 0)), 0) nooutput
stats table('steppers') using (lowest = $5 < lowest ? $5 : lowest, highest = larger(highest, $5 > 0 ? $5 : 0), 0) nooutput
set xrange [0.5 * lowest:3 * highest]
set style textbox opaque noborder margins 0.5, 0.5 fillcolor rgb 'white' # over the line of real time
unset grid; set grid xtics lc rgb '#E2E2E2' lw 0.8 dt solid
plot table('table') using CPU:(-place_of(strcol(1))):LEAST:GREATEST with xerrorbars lc rgb '#000000' pt 7 ps 1 lw 1.5, \
     '' using (column(THESIS) > 0 ? column(THESIS) : NaN):(-place_of(strcol(1))) with points pt 6 ps 1.3 lw 2 lc rgb '#D55E00', \
     for [m = 1:words(names)] table('steppers') \
        using (strcol(1) eq word(names, m) && did(strcol(3)) ? $5 : NaN):(-VARIANTS_HERE - m) \
        with points lt style_of(word(names, m)) ps 1.1, \
     for [m = 1:words(names)] '' \
        using (strcol(1) eq word(names, m) && !did(strcol(3)) ? ($5 > 0 ? $5 : lowest) : NaN):(-VARIANTS_HERE - m) \
        with points pt FAILED ps 1.1 lw 2.2 lc rgb colour_of(word(names, m)), \
     for [m = 1:words(names)] '' \
        using (strcol(1) eq word(names, m) && !did(strcol(3)) ? ($5 > 0 ? $5 : lowest) : NaN):(-VARIANTS_HERE - m) \
        :(strcol(3).($4 == $4 ? sprintf(' at %.2g s', $4) : '')) \
        with labels left offset 1.2, 0 boxed font ',11' textcolor rgb ink_of(word(names, m))
eval heading_done
eval legend(0, 475, 900, 40, 1)
plot @BLANK, keyentry with points pt 7 ps 1 lc rgb '#000000' title 'ours', \
     keyentry with points pt 6 ps 1.3 lw 2 lc rgb (has_thesis ? '#D55E00' : 'white') \
        title has_thesis ? 'thesis' : '', \
     keyentry with points pt FAILED ps 1.1 lw 2.2 lc rgb GREY title has_failed ? 'failed, and when' : ''
unset multiplot

# --- the series behind the statements ---

SERIES = words(NAMES)
eval figure('series', 900, 110 + 235 * SERIES + (VARIANTS_HERE > 1 ? 40 : 0))
set multiplot
eval heading(STORY, WHAT)
is_here(v) = strcol(1) eq word(variants_here, v)
do for [k = 1:SERIES] {
    eval panel(90, 80 + 235 * (k - 1), 780, 180)
    set autoscale; set autoscale xfix; set offsets 0, 0, graph 0.06, 0
    stats table('series') using (column(2 + k)) nooutput
    if (STATS_records && STATS_min == 0 && STATS_max == 0) { set yrange [0:1] } # nothing is below none
    set ytics nomirror out scale 0.6 font ',11'
    set xlabel k == SERIES ? 't (s)' : '' offset 0, 0.4
    set ylabel word(NAMES, k).(word(UNITS, k) eq '-' ? '' : ' ('.word(UNITS, k).')') offset 0.5, 0
    plot for [v = 1:VARIANTS_HERE] table('series') using (is_here(v) ? $2 : NaN):(column(2 + k)) \
        with lines lt (10 + v)
    eval heading_done
}
unset offsets
if (VARIANTS_HERE > 1) {
    eval legend(0, HEIGHT - 50, 900, 40, 1)
    plot @BLANK, for [v = 1:VARIANTS_HERE] keyentry with lines lt (10 + v) title word(variants_here, v)
}
unset multiplot
set output
