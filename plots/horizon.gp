# How long trajectories can be compared, and how far ensembles are from the reference's after that.
load plots.'/style.gp'
eval require('growth horizons ensembles')

scenes = ''
stats table('horizons') using (strcol(1) eq 'scene' ? 0 : (scenes = with_name(scenes, strcol(1)), 0), 0) nooutput
set linetype 31 lc rgb '#0072B2' dt solid lw 1.8 pt 7 ps 0.7
set linetype 32 lc rgb '#D55E00' dt (12,4) lw 1.8 pt 5 ps 0.7
set linetype 33 lc rgb '#009E73' dt (10,3,2,3) lw 1.8 pt 9 ps 0.8
set linetype 34 lc rgb '#CC79A7' dt (5,3) lw 1.8 pt 13 ps 0.8
line_of(s) = 31 + (s - 1) % 4

# --- the horizon ---
eval figure('horizon', 900, 560)
eval heading('How long can trajectories be compared?', \
    'largest distance of a node between two reference runs whose starts are 10^{−10} m apart (treatment generalised)')
eval panel(85, 70, 785, 380)
eval powers('y'); set mytics 1
set xlabel 'time (s)'; set ylabel 'separation (m)' offset 1, 0
set yrange [1e-13:1]
set arrow 1 from graph 0, first 1e-3 to graph 1, first 1e-3 nohead lt 2 lw 1.2
set label 3 '1 mm: the separation horizon' at graph 0.99, first 1e-3 right offset 0, 0.6 font ',11' \
    textcolor rgb GREY
eval own_key(words(scenes), 20, \
    'set key at screen 0.5, screen 0.06 center center horizontal Left reverse samplen 4')
positive(x) = x > 1e-13 ? x : 1e-13
if (SHOWN) { plot for [s = 1:words(scenes)] table('growth') \
    using (strcol(1) eq word(scenes, s) ? $2 : NaN):(positive($3)) \
    with lines lt line_of(s) title word(scenes, s) }
set output

# --- ensembles ---
eval names_of('ensembles')
members = ''
do for [n in names] { if (n ne 'reference') { members = with_name(members, n) } }
eval figure('ensembles', 1120, 560)
set multiplot
eval heading('What remains to be compared: ensembles of perturbed starts', \
    'distance of an ensemble''s mean from the reference''s, in yardsticks: the distance between two halves of the reference''s own; ×: runs failed')
LEAST = 0.02 # yardsticks; what is less is drawn there, also none where the yardstick is none
far(d, yardstick) = d > LEAST * yardstick ? d / yardstick : LEAST
told = told_of('ensembles', heads_of('ensembles'))
measures = '"mean shape" "mean energy" "number of contacts"'
do for [p = 1:3] {
    c = 4 + 2 * p
    eval panel(90 + 342 * (p - 1), 95, 310, 330)
    set title '{/:Bold '.word(measures, p).'}' offset 0, -0.5
    eval powers('y')
    set yrange [LEAST:2e4]
    set ytics add (p == 1 ? sprintf('≤ %g', LEAST) : '' LEAST)
    if (!leftmost(p == 1)) { set format y '' }
    set ylabel leftmost(p == 1) ? 'distance (yardsticks)' : '' offset 1, 0
    set xrange [0.4:words(members) + 0.6]
    set xtics ('' 0) rotate by -30 left
    do for [m = 1:words(members)] { set xtics add (word(members, m) m) }
    set arrow 1 from graph 0, first 0.7 to graph 1, first 0.7 nohead lt 2 lw 1.2
    shift(s) = (s - (words(scenes) + 1) / 2.) * 0.6 / words(scenes)
    if (SHOWN) { plot for [s = 1:words(scenes)] table('ensembles') \
            using (strcol(2) eq word(scenes, s) && place(members, strcol(1)) && $4 == 0 \
                ? place(members, strcol(1)) + shift(s) : NaN):(far(column(c), column(c + 1))) \
            with impulses lt line_of(s) lw 1, \
         for [s = 1:words(scenes)] '' \
            using (strcol(2) eq word(scenes, s) && place(members, strcol(1)) && $4 == 0 \
                ? place(members, strcol(1)) + shift(s) : NaN):(far(column(c), column(c + 1))) \
            with points lt line_of(s) ps 1.1, \
         for [s = 1:words(scenes)] '' \
            using (strcol(2) eq word(scenes, s) && place(members, strcol(1)) && $4 > 0 \
                ? place(members, strcol(1)) + shift(s) : NaN):(1.2e4) \
            with points pt FAILED lc rgb '#444444', \
         for [n = 1:has_tips] for [s = 1:words(scenes)] '' \
            using (strcol(2) eq word(scenes, s) && place(members, strcol(1)) \
                ? place(members, strcol(1)) + shift(s) : NaN) \
            :($4 > 0 ? 1.2e4 : far(column(c), column(c + 1))):(tip_of(told)) @TIP }
    eval heading_done
}
eval legend(0, 510, 1120, 40, 1)
plot @BLANK, for [s = 1:words(scenes)] keyentry with linespoints lt line_of(s) title word(scenes, s), \
     keyentry with lines lt 2 lw 1.2 title 'two ensembles of one distribution'
unset multiplot
set output
