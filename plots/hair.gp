# The figures of the experiments of the thesis's chapter 5, from the tables of one of them. Its own
# script first sets
#   STORY = 'what is seen', and for the series NAMES = '"label" ...', UNITS = '"deg" ...' and WHAT they are
load plots.'/style.gp'
eval require('table steppers series')
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
    has_thesis ? 'thesis: explicit Euler at 9000 Hz, one MIPS R4400 at 200 MHz; ours: the same recipe, median, least to greatest' \
    : 'of explicit Euler with projection at 9000 Hz, median, least to greatest, and of all steppers')
told = told_of('table', 'variant status cpu_per_frame:s normalised thesis_per_frame:s thesis_normalised force_evaluations wisp_contacts')
told_steppers = told_of('steppers', 'stepper setting status failure_time:s distance:m cpu_per_frame:s work')
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
    if (SHOWN) { plot table('table') using (place_of(strcol(1)) - 0.1):RATIO:(column(8)):(column(9)) \
            with yerrorbars lc rgb '#000000' pt 7 ps 1 lw 1.5, \
         '' using (place_of(strcol(1)) + 0.1):THESIS_RATIO with points pt 6 ps 1.3 lw 2 lc rgb '#D55E00', \
         for [n = 1:has_tips] '' using (place_of(strcol(1)) - 0.1):RATIO:(tip_of(told)) @TIP, \
         for [n = 1:has_tips] '' using (place_of(strcol(1)) + 0.1):THESIS_RATIO:(tip_of(told)) @TIP }
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
# Words stand on the side on which there is room.
side_of(x) = x > 0 && x > sqrt(lowest * highest) ? 'right' : 'left'
set style textbox opaque noborder margins 0.5, 0.5 fillcolor rgb 'white' # over the line of real time
unset grid; set grid xtics lc rgb '#E2E2E2' lw 0.8 dt solid
if (SHOWN) { plot table('table') using CPU:(-place_of(strcol(1))):LEAST:GREATEST with xerrorbars lc rgb '#000000' pt 7 ps 1 lw 1.5, \
     '' using (column(THESIS) > 0 ? column(THESIS) : NaN):(-place_of(strcol(1))) with points pt 6 ps 1.3 lw 2 lc rgb '#D55E00', \
     for [m = 1:words(names)] table('steppers') \
        using (strcol(1) eq word(names, m) && did(strcol(3)) ? $5 : NaN):(-VARIANTS_HERE - m) \
        with points lt style_of(word(names, m)) ps 1.1, \
     for [m = 1:words(names)] '' \
        using (strcol(1) eq word(names, m) && !did(strcol(3)) ? ($5 > 0 ? $5 : lowest) : NaN):(-VARIANTS_HERE - m) \
        with points pt FAILED ps 1.1 lw 2.2 lc rgb colour_of(word(names, m)), \
     for [m = 1:words(names)] '' \
        using (strcol(1) eq word(names, m) && !did(strcol(3)) && side_of($5) eq 'left' ? ($5 > 0 ? $5 : lowest) : NaN):(-VARIANTS_HERE - m) \
        :(strcol(3).($4 == $4 ? sprintf(' at %.2g s', $4) : '')) \
        with labels left offset 1.2, 0 boxed font ',11' textcolor rgb ink_of(word(names, m)), \
     for [m = 1:words(names)] '' \
        using (strcol(1) eq word(names, m) && !did(strcol(3)) && side_of($5) eq 'right' ? ($5 > 0 ? $5 : lowest) : NaN):(-VARIANTS_HERE - m) \
        :(strcol(3).($4 == $4 ? sprintf(' at %.2g s', $4) : '')) \
        with labels right offset -1.2, 0 boxed font ',11' textcolor rgb ink_of(word(names, m)), \
     for [n = 1:has_tips] '' using (place(names, strcol(1)) ? ($5 > 0 ? $5 : lowest) : NaN) \
        :(-VARIANTS_HERE - place(names, strcol(1))):(tip_of(told_steppers)) @TIP, \
     for [n = 1:has_tips] table('table') using CPU:(-place_of(strcol(1))):(tip_of(told)) @TIP, \
     for [n = 1:has_tips] '' using (column(THESIS) > 0 ? column(THESIS) : NaN):(-place_of(strcol(1))):(tip_of(told)) @TIP }
eval heading_done
eval legend(0, 475, 900, 40, 1)
plot @BLANK, keyentry with points pt 7 ps 1 lc rgb '#000000' title has_thesis ? 'ours' : 'explicit Euler at 9000 Hz', \
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
    set xlabel lowest(k == SERIES) ? 't (s)' : '' offset 0, 0.4
    set ylabel word(NAMES, k).(word(UNITS, k) eq '-' ? '' : ' ('.word(UNITS, k).')') offset 0.5, 0
    if (SHOWN) { plot for [v = 1:VARIANTS_HERE] table('series') using (is_here(v) ? $2 : NaN):(column(2 + k)) \
        with lines lt (10 + v) }
    eval heading_done
}
unset offsets
if (VARIANTS_HERE > 1) {
    eval legend(0, HEIGHT - 50, 900, 40, 1)
    plot @BLANK, for [v = 1:VARIANTS_HERE] keyentry with lines lt (10 + v) title word(variants_here, v)
}
unset multiplot
set output
