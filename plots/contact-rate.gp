# How far a motion is from that with contacts at 9000 Hz, by how often they are looked at; and who
# else errs on the same scenes.
load plots.'/style.gp'
eval require('rates series sources')

# columns of rates.tsv, series.tsv, sources.tsv
SERIES = 2; TICKS = 3; CONTACT = 4; RESPONSE = 5; RATE = 6; ERROR = 9; SECTIONS = 14
PAIRS = 18; LOWER = 19; MEDIAN = 20; UPPER = 21
OWN = 6; HORIZON = 7; COMPARED = 8; DOUBT = 10
scenes = ''
stats table('series') using (strcol(1) eq 'scene' ? 0 : (scenes = with_name(scenes, strcol(1)), 0), 0) nooutput

# Colour is the kind of contact; filled marks and whole lines are reciprocal, open and dashed ones
# are not.
kinds = '"both" "friction" "collision"'
colours = '#0072B2 #D55E00 #009E73'
filled = '7 5 9'; hollow = '6 4 8'
do for [k = 1:3] {
    eval sprintf('set linetype %d lc rgb "%s" dt solid pt %s ps 0.95 lw 1.8', 30 + k, \
        word(colours, k), word(filled, k))
    eval sprintf('set linetype %d lc rgb "%s" dt (6,4) pt %s ps 1.05 lw 1.8', 40 + k, \
        word(colours, k), word(hollow, k))
}
set linetype 31 ps 1.6 # seen also where friction or collision is all there is
set linetype 41 ps 1.7
set linetype 50 lc rgb '#7A3E9D' dt (10,3,2,3) pt 13 ps 1.1 lw 1.8 # bodies
line_of(k, one_sided) = (one_sided ? 40 : 30) + k
response(one_sided) = one_sided ? 'one-sided' : 'reciprocal'

# What is less is drawn here: no eye sees a micrometre, and 0 has no logarithm.
LEAST = 1e-3 # mm
mm(x) = x == x ? (1e3 * x > LEAST ? 1e3 * x : LEAST) : NaN
TOP = 500

# --- each scene by itself ---

of(scene, kind, one_sided) = strcol(1) eq scene && strcol(TICKS) eq 'wisps' \
    && strcol(CONTACT) eq word(kinds, kind) && strcol(RESPONSE) eq response(one_sided)

told = told_of('rates', 'series rate:Hz outcome error:m history_diverged:s contacts evaluations cpu:s after_median:m')
do for [s = 1:words(scenes)] {
    scene = word(scenes, s)
    eval figure(scene, 1100, 620)
    drawn = '' # which kinds with which response
    compared = ''; nearest = 1e300; farthest = 0; pairs = 0
    unset logscale; set autoscale
    stats table('series') using (strcol(1) eq scene && strcol(CONTACT) ne 'no contact' \
        && strcol(TICKS) eq 'wisps' ? (compared = strcol(COMPARED), \
        nearest = column(HORIZON) < nearest ? column(HORIZON) : nearest, \
        farthest = column(HORIZON) > farthest ? column(HORIZON) : farthest, 0) : 0, 0) nooutput
    stats table('rates') using (strcol(1) eq scene && column(PAIRS) > 0 ? (pairs = pairs + 1, 0) : 0, 0) nooutput
    stats table('rates') using (strcol(1) eq scene && strcol(TICKS) eq 'wisps' \
        ? (drawn = with_name(drawn, strcol(CONTACT).' '.strcol(RESPONSE)), 0) : 0, 0) nooutput
    has_bodies = 0
    stats table('rates') using (strcol(1) eq scene && strcol(TICKS) eq 'bodies' && $6 < 9000 ? (has_bodies = 1, 0) : 0, 0) nooutput
    is_drawn(k, o) = place(drawn, word(kinds, k).' '.response(o))
    spans = nearest > farthest ? '' : nearest == farthest ? sprintf('up to %.2g s', farthest) \
        : sprintf('up to the horizon of each, %.2g to %.2g s', nearest, farthest)
    set multiplot
    do for [p = 1:3] {
        eval panel(p == 1 ? 95 : p == 2 ? 480 : 845, 95, p == 1 ? 345 : p == 2 ? 325 : 230, 345)
        if (p == 1) {
            eval heading('How often must contacts be looked at? '.escaped(scene), \
                'rms distance of free nodes from the motion with ticks at 9000 Hz; rk4 with the same steps at all rates; treatment generalised')
        }
        set title '{/:Bold '.(p == 1 ? 'wisps' : p == 2 ? 'wisps, after the horizon' : 'bodies and samples') \
            .'}'.(p == 1 ? ', '.spans : '') offset 0, -0.5
        set logscale xy; set format y '%g'; set format x '%g'; unset mxtics
        set yrange [LEAST:TOP]
        set ytics (sprintf('≤ %g', LEAST) LEAST, 0.01, 0.1, 1, 10, 100)
        if (p > 1) { set ytics ('' LEAST, '' 0.01, '' 0.1, '' 1, '' 10, '' 100) }
        set xrange [p == 3 ? 220 : 22:p == 2 ? 12500 : 4100]
        set xtics (30, 90, 300, 900, 3000, 9000) offset 0, 0.2
        set xlabel 'ticks (Hz)' offset 0, 0.3
        set ylabel leftmost(p == 1) ? 'distance (mm)' : '' offset 1, 0
        set arrow 1 from graph 0, first 1 to graph 1, first 1 nohead lt 2 lw 1.2
        unset label 4
        if (p == 2 && pairs == 0) {
            set label 4 "no runs: horizons are at the\nend, or they are left out" at graph 0.5, graph 0.5 \
                center textcolor rgb GREY
        }
        if (p == 1) {
            if (SHOWN) { plot for [o = 0:1] for [k = 1:3] table('rates') \
                using (of(scene, k, o) && $6 < 9000 ? $6 : NaN):(mm(column(ERROR))) \
                with linespoints lt line_of(k, o), \
                for [n = 1:has_tips] '' using (strcol(1) eq scene && strcol(TICKS) eq 'wisps' && $6 < 9000 \
                    ? $6 : NaN):(mm(column(ERROR))):(tip_of(told)) @TIP }
        }
        if (p == 2) {
            # side by side, not on each other
            shift(k, o) = exp(0.07 * (k - 2 + 0.5 * o))
            if (SHOWN) { plot for [o = 0:1] for [k = 1:3] table('rates') \
                using (of(scene, k, o) && column(PAIRS) > 0 ? column(RATE) * shift(k, o) : NaN) \
                    :(mm(column(MEDIAN))):(mm(column(LOWER))):(mm(column(UPPER))) \
                with yerrorbars lt line_of(k, o) dt solid lw 1.4, \
                for [n = 1:has_tips] for [o = 0:1] for [k = 1:3] '' \
                using (of(scene, k, o) && column(PAIRS) > 0 ? column(RATE) * shift(k, o) : NaN) \
                    :(mm(column(MEDIAN))):(tip_of(told)) @TIP, \
                2 with lines lc bgnd }
        }
        if (p == 3) {
            if (SHOWN) { plot table('rates') using (strcol(1) eq scene && strcol(TICKS) eq 'bodies' && $6 < 9000 \
                ? $6 : NaN):(mm(column(ERROR))) with linespoints lt 50, \
                for [n = 1:has_tips] '' using (strcol(1) eq scene && strcol(TICKS) eq 'bodies' && $6 < 9000 \
                ? $6 : NaN):(mm(column(ERROR))):(tip_of(told)) @TIP }
        }
        eval heading_done
    }
    eval legend(0, 500, 1100, 110, 5)
    plot @BLANK, for [k = 1:3] keyentry with linespoints lt line_of(k, 0) \
            title is_drawn(k, 0) ? word(kinds, k).', reciprocal' : '', \
         keyentry with linespoints lt 50 title has_bodies ? 'bodies' : '', keyentry with lines lt 2 title 'a millimetre', \
         for [k = 1:3] keyentry with linespoints lt line_of(k, 1) title is_drawn(k, 1) ? word(kinds, k).', one-sided' : '', \
         keyentry with yerrorbars lt 1 lc rgb GREY title pairs ? 'median and quartiles of pairs of runs' : ''
    unset multiplot
}
set output

# --- who errs ---

# A scene a group, a source a mark: filled up to the span, open over the whole time.
sources = '"integrator" "treatment" "wisp ticks" "body ticks"'
set linetype 61 lc rgb '#555555' pt 7 ps 1.3 lw 1.6
set linetype 62 lc rgb '#D55E00' pt 5 ps 1.25 lw 1.6
set linetype 63 lc rgb '#0072B2' pt 9 ps 1.45 lw 1.6
set linetype 64 lc rgb '#7A3E9D' pt 13 ps 1.55 lw 1.6
hollow_of(k) = int(word('6 4 8 12', k))
array span[words(scenes)]
there = 0
stats table('sources') using (strcol(1) eq 'scene' ? 0 : (there = there + 1, 0), 0) nooutput
do for [s = 1:words(scenes)] {
    span[s] = ''
    stats table('sources') using (strcol(1) eq word(scenes, s) \
        ? (span[s] = $7 == $7 ? sprintf('%.2g of %.3g s', $7, $8) : 'no span', 0) : 0, 0) nooutput
}
if (there > 0) {
    eval figure('sources', 900, 170 + 95 * words(scenes))
    set multiplot
    eval panel(175, 75, 690, 95 * words(scenes) - 10)
    eval heading('Where does effort belong?', \
        'error of the source''s recipe by where it comes from, rms over free nodes and frames: up to the span (filled), to the end (open)')
    set logscale x; set format x '%g'; unset mxtics
    set xrange [LEAST:TOP]; set yrange [words(scenes) + 0.5:0.5]
    set xtics (sprintf('≤ %g', LEAST) LEAST, 0.01, 0.1, 1, 10, 100) offset 0, 0.2
    set xlabel 'error (mm)' offset 0, 0.3
    unset ytics; unset grid; set grid xtics lc rgb '#E2E2E2' lw 0.8 dt solid
    do for [s = 1:words(scenes)] {
        set label 10 + s '{/:Bold '.escaped(word(scenes, s)).'}' at graph 0, first s right offset -1, 0.5
        set label 80 + s span[s] at graph 0, first s right offset -1, -0.6 font ',11' textcolor rgb GREY
        if (s > 1) {
            set arrow 10 + s from graph 0, first s - 0.5 to graph 1, first s - 0.5 nohead \
                lc rgb '#CCCCCC' lw 0.8
        }
    }
    row_of(k) = place(scenes, strcol(1)) + 0.2 * (k - 2.5)
    told = told_of('sources', 'scene source error:m whole:m span:s compared:s')
    is(k) = strcol(2) eq word(sources, k) && !($3 < 1e-12) # none, where there are no bodies
    drawn = ''
    stats table('sources') using (drawn = $3 < 1e-12 ? drawn : with_name(drawn, strcol(2)), 0) nooutput
    when(k, words) = place(drawn, word(sources, k)) ? words : ''
    if (SHOWN) { plot for [k = 1:4] table('sources') using (is(k) ? mm($3) : NaN):(row_of(k)):(mm($5) - mm($3)):(0) \
            with vectors nohead lt 60 + k lw 1, \
         for [k = 1:4] '' using (is(k) ? mm($5) : NaN):(row_of(k)) with points lt 60 + k pt hollow_of(k), \
         for [k = 1:4] '' using (is(k) ? mm($3) : NaN):(row_of(k)) with points lt 60 + k, \
         for [n = 1:has_tips] for [k = 1:4] for [c in '5 3'] '' \
            using (is(k) ? mm(column(int(c))) : NaN):(row_of(k)):(tip_of(told)) @TIP }
    eval heading_done
    eval legend(0, HEIGHT - 55, WIDTH, 40, 1)
    plot @BLANK, keyentry with points lt 61 title when(1, 'integrator (Euler, 9000 Hz)'), \
         keyentry with points lt 62 title when(2, 'treatment (projection)'), \
         keyentry with points lt 63 title when(3, 'ticks of wisps'), \
         keyentry with points lt 64 title when(4, 'ticks of bodies')
    unset multiplot
    set output
}

# --- what looking more often buys and costs ---

set linetype 71 lc rgb '#0072B2' dt solid pt 7 ps 0.95 lw 1.8
set linetype 72 lc rgb '#D55E00' dt (12,4) pt 5 ps 0.95 lw 1.8
set linetype 73 lc rgb '#F0A030' dt (4,3) pt 4 ps 1.0 lw 1.8
set linetype 74 lc rgb '#009E73' dt (10,3,2,3) pt 9 ps 1.05 lw 1.8
set linetype 75 lc rgb '#7A3E9D' dt (5,3) pt 13 ps 1.1 lw 1.8
scene_line(s) = 71 + (s - 1) % 5
own = ''
stats table('series') using (strcol(1) ne 'scene' && strcol(TICKS) eq 'wisps' && column(OWN) == 1 \
    ? (own = with_name(own, strcol(1).'/'.strcol(SERIES)), 0) : 0, 0) nooutput
array seconds[words(scenes)]
do for [s = 1:words(scenes)] {
    seconds[s] = NaN
    stats table('series') using (strcol(1) eq word(scenes, s) ? (seconds[s] = column(COMPARED), 0) : 0, 0) nooutput
}
if (words(own) > 0) {
    eval figure('cost', 900, 540)
    set multiplot
    eval panel(95, 70, 775, 375)
    eval heading('What does looking more often buy, and cost?', \
        'the contact of each scene as it is, each mark a rate (left to right; 30 to 3000 Hz); beside it each tick is a stop of the advance')
    set logscale xy; set format y '%g'; eval powers('x')
    set yrange [LEAST:TOP]; set ytics (sprintf('≤ %g', LEAST) LEAST, 0.01, 0.1, 1, 10, 100)
    set xlabel paper eq '' ? 'sections in which points are looked for, in a simulated second' : 'sections searched in a simulated second'
    set ylabel 'distance from 9000 Hz (mm)' offset 1, 0
    set arrow 1 from graph 0, first 1 to graph 1, first 1 nohead lt 2 lw 1.2
    set label 3 '1 mm' at graph 0.005, first 1 left offset 0.2, 0.5 font ',11' textcolor rgb GREY
    told = told_of('rates', 'scene series rate:Hz outcome error:m contacts sections evaluations cpu:s')
    is_own(s) = strcol(1) eq word(scenes, s) && strcol(TICKS) eq 'wisps' \
        && place(own, strcol(1).'/'.strcol(SERIES)) > 0 && $6 < 9000
    if (SHOWN) { plot for [s = 1:words(scenes)] table('rates') \
        using (is_own(s) ? column(SECTIONS) / seconds[s] : NaN):(mm(column(ERROR))) \
        with linespoints lt scene_line(s), \
        for [n = 1:has_tips] for [s = 1:words(scenes)] '' \
        using (is_own(s) ? column(SECTIONS) / seconds[s] : NaN):(mm(column(ERROR))):(tip_of(told)) @TIP }
    eval heading_done
    eval legend(0, 492, 900, 40, 1)
    plot @BLANK, for [s = 1:words(scenes)] keyentry with linespoints lt scene_line(s) title word(scenes, s)
    unset multiplot
    set output
}
set output

# --- bodies by penalty ---

# columns of penalty.tsv: frequency 0 is of ticks, drawn as a line across.
eval require('penalty penalty-steps')
FREQUENCY = 3; DEPTH = 5; PENALTY_ERROR = 6; COUNTED = 10
pushed = ''
stats table('penalty') using (strcol(1) eq 'scene' ? 0 : (pushed = with_name(pushed, strcol(1)), 0), 0) nooutput
do for [k = 1:5] {
    eval sprintf('set linetype %d lc rgb "%s" dt solid pt %d ps 1.05 lw 1.8', 80 + k, \
        word('#0072B2 #D55E00 #009E73 #7A3E9D #F0A030', k), int(word('7 5 9 13 11', k)))
    eval sprintf('set linetype %d lc rgb "%s" dt (4,3) lw 1.4', 85 + k, \
        word('#0072B2 #D55E00 #009E73 #7A3E9D #F0A030', k))
}
pushed_line(s) = 81 + (s - 1) % 5
ticks_line(s) = 86 + (s - 1) % 5
if (words(pushed)) {
    eval figure('penalty', 1160, 480)
    told = told_of('penalty', 'scene frequency:Hz outcome depth:m error:m evaluations')
    array at_ticks[3 * words(pushed)]
    do for [s = 1:words(pushed)] {
        do for [p = 1:3] { at_ticks[3 * (s - 1) + p] = NaN }
        stats table('penalty') using (strcol(1) eq word(pushed, s) && column(FREQUENCY) == 0 \
            ? (at_ticks[3 * s - 2] = mm(column(DEPTH)), at_ticks[3 * s - 1] = mm(column(PENALTY_ERROR)), \
               at_ticks[3 * s] = column(COUNTED), 0) : 0, 0) nooutput
    }
    set multiplot
    do for [p = 1:3] {
        eval panel(p == 1 ? 95 : p == 2 ? 480 : 865, 95, 270, 275)
        if (p == 1) {
            eval heading('Bodies that push by penalty, and ticks', \
                'rk4 with the same steps, treatment generalised; dashed: ticks at the scene''s own rate')
        }
        set title '{/:Bold '.(p == 1 ? 'how deep nodes come' : p == 2 ? 'how far from ticks at 9000 Hz' \
            : 'what it costs').'}' offset 0, -0.5
        set logscale xy; set format x '%g'; unset mxtics; set format y '%g'
        set xrange [7:1430]; set xtics (10, 30, 100, 300, 1000)
        set xlabel 'frequency of the penalty (Hz)' offset 0, 0.3
        if (p < 3) {
            set yrange [LEAST:TOP]
            set ytics (sprintf('≤ %g', LEAST) LEAST, 0.01, 0.1, 1, 10, 100)
            set ylabel p == 1 ? 'depth (mm)' : 'rms distance (mm)' offset 2.5, 0
            set arrow 1 from graph 0, first 1 to graph 1, first 1 nohead lt 2 lw 1.2
        } else {
            unset arrow 1
            unset logscale y
            set yrange [0:1.6]; set ytics 0.4
            set ylabel 'cost over that with ticks' offset 0, 0
        }
        charted(s) = p == 1 ? mm(column(DEPTH)) : p == 2 ? mm(column(PENALTY_ERROR)) \
            : column(COUNTED) / at_ticks[3 * s]
        level(s) = p == 3 ? 1 : at_ticks[3 * (s - 1) + p]
        if (SHOWN) { plot for [s = 1:words(pushed)] table('penalty') using (strcol(1) eq word(pushed, s) \
                && column(FREQUENCY) > 0 ? column(FREQUENCY) : NaN):(charted(s)) \
                with linespoints lt pushed_line(s), \
             for [n = 1:has_tips] for [s = 1:words(pushed)] '' using (strcol(1) eq word(pushed, s) \
                && column(FREQUENCY) > 0 ? column(FREQUENCY) : NaN):(charted(s)):(tip_of(told)) @TIP, \
             for [s = 1:words(pushed)] level(s) with lines lt ticks_line(s) }
        eval heading_done
    }
    eval legend(0, 425, 1160, 40, 1)
    plot @BLANK, for [s = 1:words(pushed)] keyentry with linespoints lt pushed_line(s) title word(pushed, s), \
         keyentry with lines lt 86 title 'the same with ticks', keyentry with lines lt 2 title 'a millimetre'
    unset multiplot
    set output
}

# A panel a kind of hair; the longest step over the frequency, and with ticks at the left.
STEP_FREQUENCY = 2; METHOD = 3; LONGEST = 5
hairs = ''; stepping = ''
stats table('penalty-steps') using (strcol(1) eq 'hair' ? 0 : (hairs = with_name(hairs, strcol(1)), 0), 0) nooutput
if (words(hairs)) {
    # who is drawn by name: those whose longest step changes most, and the classics
    names = ''; chosen = ''
    stats table('penalty-steps') using (strcol(1) ne 'hair' && column(LONGEST) > 0 \
        ? (names = with_name(names, strcol(METHOD)), 0) : 0, 0) nooutput
    do for [m in 'euler rk4 symplectic-euler linear-euler bdf2 implicit-euler midpoint bdf3'] {
        if (place(names, m)) { chosen = named(chosen, m) }
    }
    eval part_names
    eval figure('penalty-steps', words(hairs) > 1 ? 1000 : 640, 500)
    set multiplot
    do for [h = 1:words(hairs)] {
        eval panel(85 + 465 * (h - 1), 95, words(hairs) > 1 ? 415 : 520, 280)
        if (h == 1) {
            eval heading('How long steps may be against a body', words(hairs) > 1 \
                ? 'one wisp that falls onto a ball: the longest step that stays within a twentieth of its length from the reference' \
                : 'one wisp that falls onto a ball: the longest step within a twentieth of its length')
        }
        set title '{/:Bold '.(word(hairs, h) eq 'rigid' ? 'rigid segments' : 'springs').'}' offset 0, -0.5
        eval powers('y'); set logscale x; set format x '%g'; unset mxtics
        set xrange [2.2:1430]; set xtics ('ticks' 3, 10, 30, 100, 300, 1000)
        set yrange [5e-5:0.05]
        set xlabel 'frequency of the penalty (Hz)' offset 0, 0.3
        set ylabel leftmost(h == 1) ? 'step (s)' : '' offset 0, 0
        if (!leftmost(h == 1)) { set format y '' }
        told = told_of('penalty-steps', 'method frequency:Hz step:s error:m beyond')
        is(m, list) = strcol(1) eq word(hairs, h) && strcol(METHOD) eq word(list, m)
        stands(x) = column(STEP_FREQUENCY) > 0 ? column(STEP_FREQUENCY) : NaN
        if (SHOWN) { plot for [m = 1:words(rest)] table('penalty-steps') \
                using (is(m, rest) ? stands(0) : NaN):LONGEST with lines lt REST, \
             for [m = 1:words(names)] table('penalty-steps') \
                using (is(m, names) ? stands(0) : NaN):LONGEST with linespoints lt style_of(word(names, m)), \
             for [m = 1:words(names)] table('penalty-steps') \
                using (is(m, names) && column(STEP_FREQUENCY) == 0 ? 3 : NaN):LONGEST \
                with points lt style_of(word(names, m)), \
             for [n = 1:has_tips] '' using (strcol(1) eq word(hairs, h) ? (column(STEP_FREQUENCY) > 0 \
                ? column(STEP_FREQUENCY) : 3) : NaN):LONGEST:(tip_of(told)) @TIP }
        eval heading_done
    }
    eval legend(0, 430, WIDTH, 60, 3)
    plot @BLANK, for [m = 1:words(names)] keyentry with linespoints lt style_of(word(names, m)) \
            title word(names, m), keyentry with lines lt REST title rest_title(rest)
    unset multiplot
    set output
}
