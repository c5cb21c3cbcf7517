# The circle test: the thesis's figures 2.4 and 2.5, error against time and cost, and the radius.
load plots.'/style.gp'
eval require('orbits-30s orbits-160s work-precision work-precision-slopes radius radius-predicted')

RADIUS = 0.9; RATE = 0.2 / 0.9 # m, rad/s: experiments/circle.cfg
PANELS = 7; DRAWN = 6          # the seventh run of the orbits tables is drawn in error-time only
array title_of[PANELS]; array stepper_of[PANELS]; array step_of[PANELS]; array rows_of[PANELS]
array end_x[PANELS]; array end_y[PANELS]; array end_error[PANELS]; array worst[PANELS]
array reach[PANELS]; array calls_of[PANELS]
larger(a, b) = a > b ? a : b

# Panel k of a table: what it is, where it ends (its last row), how far out it gets. The variant's
# name for its style is the stepper with the word after the title's comma: 'euler projected'.
take(k) = (title_of[k] = strcol(2), stepper_of[k] = strcol(3), step_of[k] = $4, \
           rows_of[k] = rows_of[k] + 1, end_x[k] = $6, end_y[k] = $7, end_error[k] = $8, calls_of[k] = $9, \
           worst[k] = larger(worst[k], $8), \
           reach[k] = larger(reach[k], larger(abs($6), abs($7))), 0)
read_panels(name) = 'do for [k = 1:PANELS] { rows_of[k] = 0; worst[k] = 0; reach[k] = 0; ' \
    .'stats table("'.name.'") using (strcol(1) eq sprintf("%d", k) ? take(k) : 0, 0) nooutput }'
after_comma(title) = strstrt(title, ', ') ? ' '.title[strstrt(title, ', ') + 2:*] : ''
before_comma(title) = strstrt(title, ', ') ? title[1:strstrt(title, ', ') - 1] : title
variant_of(title) = strstrt(title, ', ') ? title[strstrt(title, ', ') + 2:*].', ' : ''
style_name(k) = stepper_of[k].after_comma(title_of[k])

# --- figures 2.4 and 2.5 ---

do for [end in "30 160"] {
    name = 'orbits-'.end.'s'
    T = real(end)
    eval figure(name, 900, 800)
    eval read_panels(name)
    # One scale for all, except for who leaves the circle by more than twice its radius.
    common = RADIUS
    do for [k = 1:DRAWN] { common = rows_of[k] && reach[k] < 3 * RADIUS ? larger(common, reach[k]) : common }
    common = 1.12 * common
    NARROWEST = 0.5 # two are side by side in a column
    set multiplot
    eval heading(sprintf('A particle on a circle, after %s s', end), \
        'positions from step to step, joined by straight lines; clockwise from (0.9, 0) at 0.2 m/s')
    set size ratio -1
    do for [k = 1:DRAWN] {
        if (rows_of[k] == 0) { continue }
        column = (k - 1) % 3; row = (k - 1) / 3
        eval panel(70 + 285 * column, 112 + 325 * row, 240, 240)
        own = reach[k] >= 3 * RADIUS
        limit = own ? 1.08 * reach[k] : common
        set xrange [-limit:limit]; set yrange [-limit:limit]
        is_narrow = paper_width(0) < 200
        apart = own ? (is_narrow ? 20 : 10) : 1
        set xtics apart; set ytics own ? 10 : 1
        set mxtics 2; set mytics 2; set xtics offset 0, 0.3
        # Over a narrow panel are three lines in place of two.
        set label 3 is_narrow ? sprintf('{/:Bold %s}', before_comma(title_of[k])) \
            : sprintf('{/:Bold %s}, h = %g s', title_of[k], step_of[k]) \
            at graph 0, graph 1 offset character 0, (is_narrow ? 2.7 : 1.75) left textcolor rgb ink_of(stepper_of[k])
        set label 6 is_narrow ? sprintf('%sh = %g s', variant_of(title_of[k]), step_of[k]) : '' \
            at graph 0, graph 1 offset character 0, 1.7 left font ',11' textcolor rgb ink_of(stepper_of[k])
        set label 4 end_error[k] < 1e-9 ? (is_narrow ? '' : 'at the end: ').'no error but rounding' \
            : sprintf(paper eq '' ? 'at the end: %.2g m from the exact position' : 'at the end %.2g m off', end_error[k]) \
            at graph 0, graph 1 offset character 0, 0.7 left font ',11' textcolor rgb GREY
        if (own) {
            set label 5 sprintf(is_narrow ? 'scale: %.0f times' : 'own scale, %.0f times the others''', limit / common) \
                at graph 0.5, graph (is_narrow ? 0.055 : 0.04) center font ',11' front
        }
        set xlabel lowest(row == 1 || (k + 3 <= DRAWN && rows_of[k + 3] == 0)) ? 'x (m)' : '' offset 0, 0.4
        set ylabel leftmost(column == 0 || rows_of[k - 1] == 0) ? 'y (m)' : '' offset 1, 0
        is = style_of(stepper_of[k])
        set samples 361; set parametric; set trange [0:2 * pi]
        if (SHOWN) { plot table(name) using (strcol(1) eq sprintf('%d', k) ? $6 : NaN):7 with lines \
                lt is dt solid lw 1.3, \
             for [j = 1:(end eq '30')] '' using (strcol(1) eq sprintf('%d', k) ? $6 : NaN):7 \
                with points lt is pt 7 ps 0.28, \
             RADIUS * cos(t), RADIUS * sin(t) with lines lt 2, \
             '+' using (end_x[k]):(end_y[k]) every ::0::0 with points pt mark_of(stepper_of[k]) \
                ps 1.6 lc rgb 'black', \
             '+' using (RADIUS * cos(RATE * T)):(-RADIUS * sin(RATE * T)) every ::0::0 \
                with points pt 6 ps (own ? 0.9 : 2.2) lw 1.6 lc rgb 'black', \
             '+' using (end_x[k]):(end_y[k]) every ::0::0 with points lt is ps 1.1, \
             for [n = 1:has_tips] '+' using (end_x[k]):(end_y[k]):(tip(sprintf( \
                "%s, h = %g s\nerror %.3g m\n%d force evaluations", title_of[k], step_of[k], \
                end_error[k], calls_of[k]))) every ::0::0 @TIP }
        unset parametric
        eval heading_done; unset label 5
    }
    eval legend(0, 740, 900, 55, 2)
    plot @BLANK, keyentry with lines lt 2 title 'exact circle', \
         keyentry with points pt 6 ps 2.2 lw 1.6 lc rgb 'black' title 'exact position at the end', \
         keyentry with lines lt 1 title 'trajectory', \
         keyentry with points pt 7 ps 1.15 lc rgb GREY title 'where it ends (the method''s own mark)'
    unset multiplot
}

# --- error against time ---

eval figure('error-time', 900, 575)
eval read_panels('orbits-160s')
eval heading('Distance from the exact position, over 160 s', \
    'legend: step, and force evaluations of the whole run')
eval panel(115, 70, 445, 430)
eval powers('y')
LOW = 1e-5; EXACT = LOW * 0.25 # an error of rounding's size has a place of its own
set yrange [LOW * 0.07:50]; set xrange [0:165]
set ytics LOW, 10; set mytics 1
set ytics add ('rounding' EXACT)
do for [k = 1:PANELS] {
    if (rows_of[k] && worst[k] < 1e-9) {
        set label 3 sprintf('always below 10^{%.0f} m ', ceil(log10(larger(worst[k], 1e-16)))) at 4, EXACT left \
            offset 0, -0.75 font ',11' textcolor rgb ink_of(stepper_of[k])
    }
}
set xtics 20
set xlabel 't (s)'; set ylabel 'error (m)' offset 1.5, 0
set arrow from graph 0, first LOW * 0.6 to graph 1, first LOW * 0.6 nohead lc rgb GREY lw 0.8
eval own_key(8, 38, sprintf('set key at screen %g, screen %g left top Left reverse samplen 4 spacing 1.5', 575./WIDTH, 1 - 80./HEIGHT))
shown(k, e) = worst[k] < 1e-9 ? EXACT : e < LOW ? NaN : e
do for [k = 1:PANELS] { if (rows_of[k]) { s = style_of(style_name(k)) } } # in the panels' order
# The legend in the order of the curves' right ends.
order = ''; listed = ''
do for [n = 1:PANELS] {
    best = 0
    do for [k = 1:PANELS] {
        if (rows_of[k] && !place(listed, sprintf('%d', k)) \
            && (best == 0 || end_error[k] > end_error[best])) { best = k }
    }
    if (best) { order = order.sprintf(' %d', best); listed = order }
}
every_mark(k) = larger(1, floor(20 / step_of[k] + 0.5))
label_of(k) = sprintf('%s, %g s: %g', title_of[k], step_of[k], calls_of[k])
run(w) = int(word(order, w))
told = told_of('orbits-160s', 'title step:s t:s error:m force_evaluations')
is_marked(t, step) = floor(t / step + 0.5) % every_mark(int($1)) == 0
if (order eq '') {
    if (SHOWN) { plot RADIUS with lines lt 2 title sprintf('radius, %g m', RADIUS) }
} else {
    if (SHOWN) { plot RADIUS with lines lt 2 title sprintf('radius, %g m', RADIUS), \
         for [w = 1:words(order)] table('orbits-160s') \
            using (strcol(1) eq word(order, w) ? $5 : NaN):(shown(run(w), $8)) \
            with linespoints lt style_of(style_name(run(w))) \
            pi every_mark(run(w)) title label_of(run(w)), \
         for [k = 1:has_tips] table('orbits-160s') \
            using (strcol(1) ne 'panel' && is_marked($5, $4) ? $5 : NaN) \
            :(strcol(1) eq 'panel' ? NaN : shown(int($1), $8)):(tip_of(told)) @TIP }
}

# --- error against cost ---

eval names_of('work-precision')
chosen = '' # the thesis's, those that have a slope, then in their order
stats table('orbits-30s') using (place(names, strcol(3)) ? (chosen = named(chosen, strcol(3)), 0) : 0) nooutput
stats table('work-precision-slopes') using (place(names, strcol(1)) ? (chosen = named(chosen, strcol(1)), 0) : 0) nooutput
do for [m = 1:words(names)] { chosen = named(chosen, word(names, m)) }
eval part_names
eval figure('work-precision', 900, 640)
set multiplot
eval heading('What accuracy costs', \
    'largest position error at 9 times in 160 s; lower and further left is better; legend: slopes over evaluations')
TOP = 3. # m: whose error is larger has lost the circle, by how much is of no interest
is_failed(status) = status ne 'finished'
is_off(error, status) = !is_failed(status) && error > TOP
# Above the scale every method that needs it has a row of its own.
in_band = ''
stats table('work-precision') using (in_band = !place(names, strcol(1)) ? in_band \
    : is_off($4, strcol(10)) || is_failed(strcol(10)) ? with_name(in_band, strcol(1)) : in_band, 0) nooutput
BOTTOM = 1e-13 # smaller ones are rounding
smallest = TOP
stats table('work-precision') using (smallest = $4 > 0 && $4 < smallest ? $4 : smallest, 0) nooutput
lowest = smallest > BOTTOM ? 10 ** floor(log10(smallest)) : BOTTOM
row_of(name) = TOP * 10 ** (0.75 * place(in_band, name))
highest = TOP * 10 ** (0.75 * (words(in_band) + 0.7))

# Each method with its slope.
titles = ''
do for [m = 1:words(names)] {
    slope = ''
    stats table('work-precision-slopes') using (strcol(1) eq word(names, m) \
        ? (slope = ': '.slope_text(strcol(2), $3, $4), 0) : 0, 0) nooutput
    titles = titles.quoted(word(names, m).slope)
}

is(m) = strcol(1) eq word(names, m)
at(x) = x > 0 ? x : 0.6 * first # a run that was killed could not say what it had done
left_half(x) = log(at(x) / first) < 0.5 * log(last / first)
# Of the first failure of each method it is said what it was.
said(name) = place(said_of, name) ? '' : (said_of = with_name(said_of, name), \
    strcol(10).($11 == $11 ? sprintf(' at t = %g s', $11) : ''))
failed_here(m, side) = is(m) && is_failed(strcol(10)) && (side eq 'left') == left_half(column(c))
told = told_of('work-precision', 'method setting status failure_time:s error:m cpu_median:s force_evaluations')
height_here(x) = $4 <= TOP && !is_failed(strcol(10)) ? larger($4, BOTTOM) \
    : place(in_band, strcol(1)) ? row_of(strcol(1)) : NaN
do for [p = 1:2] {
    c = p == 1 ? 7 : 5
    first = 1e300; last = 0
    unset logscale; set autoscale # stats leaves out what is out of range
    stats table('work-precision') using (x = column(c), \
        first = x > 0 && x < first ? x : first, last = x > last ? x : last, 0) nooutput
    if (last == 0) { first = 1; last = 10 }
    eval panel(p == 1 ? 90 : 505, 70, 380, 430)
    eval powers('x'); eval powers('y')
    if (!leftmost(p == 1)) { set format y '' }
    set xrange [0.6 * first:1.7 * last]
    set yrange [lowest:highest]
    set ytics 1e-12, 100, 1; set mytics 1
    set xtics offset 0, 0.3
    set xlabel p == 1 ? 'CPU time (s)'.SPREAD : 'force evaluations'
    set ylabel leftmost(p == 1) ? 'largest error (m)' : '' offset 1, 0
    unset label 3
    if (words(in_band)) {
        set arrow 1 from graph 0, first TOP to graph 1, first TOP nohead lc rgb GREY lw 0.8
        set label 3 sprintf('error above %g m', TOP) at graph 0.99, first TOP right \
            offset 0, 0.6 font ',11' textcolor rgb GREY
    }
    said_of = ''
    set bars 0
    if (SHOWN) { plot for [m = 1:words(rest)] table('work-precision') \
            using (strcol(1) eq word(rest, m) && $4 <= TOP ? column(c) : NaN):(larger($4, BOTTOM)) \
            with lines lt REST, \
         for [m = 1:words(names)] table('work-precision') \
            using (is(m) && $4 <= TOP ? column(c) : NaN):(larger($4, BOTTOM)) \
            :(p == 1 ? $8 : $5):(p == 1 ? $9 : $5) \
            with xerrorbars lt style_of(word(names, m)) dt solid lw 1 pt 0, \
         for [m = 1:words(names)] '' using (is(m) && $4 <= TOP ? column(c) : NaN):(larger($4, BOTTOM)) \
            with linespoints lt style_of(word(names, m)), \
         for [m = 1:words(names)] '' \
            using (is(m) && is_off($4, strcol(10)) ? at(column(c)) : NaN):(row_of(strcol(1))) \
            with points lt style_of(word(names, m)), \
         for [m = 1:words(names)] '' \
            using (is(m) && is_failed(strcol(10)) ? at(column(c)) : NaN):(row_of(strcol(1))) \
            with points pt FAILED ps 1.1 lw 2.2 lc rgb colour_of(word(names, m)), \
         for [m = 1:words(names)] '' \
            using (failed_here(m, 'left') ? at(column(c)) : NaN):(row_of(strcol(1))) \
            :(failed_here(m, 'left') ? said(strcol(1)) : '') \
            with labels left offset 0.9, 0 font ',11' textcolor rgb ink_of(word(names, m)), \
         for [m = 1:words(names)] '' \
            using (failed_here(m, 'right') ? at(column(c)) : NaN):(row_of(strcol(1))) \
            :(failed_here(m, 'right') ? said(strcol(1)) : '') \
            with labels right offset -0.9, 0 font ',11' textcolor rgb ink_of(word(names, m)), \
         for [k = 1:has_tips] '' using (strcol(1) ne 'method' ? at(column(c)) : NaN):(height_here(0)) \
            :(tip_of(told)) @TIP }
    eval heading_done
}
eval legend(0, 555, 900, 85, 3)
plot @BLANK, for [m = 1:words(names)] keyentry with linespoints lt style_of(word(names, m)) \
        title word(titles, m), \
     keyentry with lines lt REST title rest_title(rest)
unset multiplot

# --- the radius that the stability function predicts ---

eval figure('radius', 900, 600)
eval names_of('radius-predicted')
predicted = names
eval names_of('radius')
mark_size(name) = place(predicted, name) || !place(predicted, word(name, 1)) ? 0.85 \
    : 1.5 # a variant stands around its method's mark
ROUNDING = 3e-12 # |R|^n has itself no more digits
# Iterated implicit Euler has the orbit of R too, but lets a deviation from it grow by
# (1 + x^2) / (1 - x^2) a step, x = omega h: its step maps s = v / p to s' with
# s = (s' + h |s'|^2) / (1 - h s'), to be linearised at -i omega. (With h = 2.5 s and 20 digits in
# place of 16 its radius is that of R; Newton's tolerance changes nothing.)
growth(x) = abs((1 + x ** 2) / (1 - x ** 2))
off = NaN
stats table('radius') using (strcol(1) eq 'implicit-euler newton' && abs(log($5 / $6)) > 0.1 \
    ? (off = $3, off_growth = growth($4), off_steps = $7, 0) : 0, 0) nooutput
told = told_of('radius', 'method step:s radius:m predicted:m steps')
set multiplot
eval heading('Radius after 160 s: measured, and predicted by the stability function', \
    'marks: measured (none: the run failed); curves: 0.9 m · |R(−iωh)|^n, R the method''s stability function (none: no prediction)')
eval powers('x')
set xrange [1.5e-3:30]
set xtics offset 0, 0.3
set xlabel 'step h (s)'
do for [p = 1:2] {
    eval panel(p == 1 ? 80 : 540, 70, 345, 400)
    eval powers('y'); set mytics 1
    if (p == 1) {
        set yrange [1e-8:1e10]; set ytics 1e-8, 100
        set ylabel 'radius (m)'
        drawn(r) = r > 0 ? r : NaN
    } else {
        set yrange [3e-14:1e10]; set ytics 1e-11, 100, 1e9; set ytics add ('≤ 10^{−13}' 1e-13)
        set ylabel 'distance from 0.9 m, over 0.9 m'
        drawn(r) = larger(abs(r / RADIUS - 1), 1e-13)
    }
    if (p == 1) { set arrow 1 from graph 0, first RADIUS to graph 1, first RADIUS nohead lt 2 } \
    else { unset arrow 1; unset label 3 }
    if (p == 1 && off == off) {
        set label 3 sprintf("newton at %g s: what\ndeviates from the spiral\ngrows %.2g-fold a step, so\n" \
            ."rounding (2^{−53}) is as\nlarge as it after %.0f\nsteps of %.0f", off, off_growth, \
            53 * log(2) / log(off_growth), off_steps) at graph 0.02, graph 0.27 left font ',11' \
            textcolor rgb ink_of('implicit-euler')
    }
    if (SHOWN) { plot 1 with dots lc bgnd, \
         for [m = 1:words(names)] table('radius-predicted') using (is(m) && !(p == 2 && drawn($4) < ROUNDING) ? $3 : NaN):(drawn($4)) \
            with lines lt style_of(word(names, m)), \
         for [m = 1:words(names)] table('radius') using (is(m) ? $3 : NaN):(drawn($5)) \
            with points lt style_of(word(names, m)) ps mark_size(word(names, m)), \
         for [k = 1:has_tips] '' using (strcol(1) eq 'method' ? NaN : $3):(drawn($5)):(tip_of(told)) @TIP }
    eval heading_done
}
eval legend(0, 520, 900, 75, 3)
plot @BLANK, keyentry with lines lt 2 title 'exact: 0.9 m', \
     for [m = 1:words(predicted)] keyentry with linespoints lt style_of(word(predicted, m)) \
        title word(predicted, m), \
     for [m = 1:words(names)] keyentry with points lt style_of(word(names, m)) \
        ps mark_size(word(names, m)) title place(predicted, word(names, m)) ? '' : word(names, m)
unset multiplot
set output
