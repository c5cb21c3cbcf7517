# Where each stepper is stable: on the smallest systems, on wisps, and what it does there.
load plots.'/style.gp'
eval require('regions oscillator damping limits')

# Marks that lie on each other show: the first are larger.
size_of(m) = 0.75 + 0.6 * (words(names) - m) / words(names)

# --- maps of growth ---

# One panel for each stepper: grey where steps do not grow, the stability function's line over it. A
# block of the table is a stepper.
X = 2; Y = 3; GROWTH = 4; THEORY = 5
STABLE = '#D4D4D4'
# ADAPTIVE ones have no step to force; others without a theory have no line.

# `$line`: where the theory of stepper i is 1, if it has one.
has_line = 0
count_line(x) = (has_line = column(THEORY) > 0 ? 1 : has_line, 0)
trace(name, i) = 'has_line = 0; stats table("'.name.'") index '.(i - 1) \
    .' using (count_line(0)) nooutput; if (has_line) { ' \
    .'set contour base; unset surface; set cntrparam levels discrete 1; ' \
    .'set table $line; splot table("'.name.'") index '.(i - 1) \
    .' using X:Y:THEORY; unset table; unset contour; set surface }'
remark(name) = place(ADAPTIVE, name) ? ', its own steps, rtol 0.01' : has_line ? '' : ', no prediction'
cell(x) = column(GROWTH) <= 1.000001 ? 1 : NaN
# Contours come with spaces between their numbers.
map(name, i) = 'set datafile separator whitespace; ' \
    .'plot table("'.name.'") index '.(i - 1).' using X:Y:(cell(0)) with image' \
    .(has_line ? ', $line using 1:2 with lines lt style_of(word(names, i)) dt solid lw 2.4' : '') \
    .'; set datafile separator "\t"'

set_map(title, subtitle, wide, high, down) = \
    figure(title, columns == 1 ? 560 : 75 + (wide + 40) * columns, 95 + (high + down) * rows + 40)
map_style = 'set palette defined (0 "'.STABLE.'", 1 "'.STABLE.'"); unset colorbox; set cbrange [0:1]'

eval names_of('regions')
columns = words(names) < 3 ? words(names) : 3
rows = (words(names) + columns - 1) / columns
S = 270; DOWN = 92 # between rows: an axis with its label, and the next one's title
eval set_map('regions', '', S, S, DOWN)
eval map_style
set multiplot
eval heading('Where steps of u′ = zu do not grow', 'by steps of h = 1 of the real code')
do for [i = 1:words(names)] {
    eval trace('regions', i)
    eval panel(60 + (S + 40) * ((i - 1) % columns), 90 + (S + DOWN) * ((i - 1) / columns), S, S)
    set title '{/:Bold '.word(names, i).'}'.remark(word(names, i)) offset 0, -0.6
    set xrange [-4.05:3.05]; set yrange [-3.55:3.55]; set xtics 1; set ytics 1 # pixels are whole
    set xlabel 'Re z' offset 0, 0.6
    set ylabel leftmost((i - 1) % columns == 0) ? 'Im z' : '' offset 1, 0
    set arrow 1 from 0, -3.55 to 0, 3.55 nohead lt 2 lw 1.2 front
    eval map('regions', i)
    eval heading_done
}
eval legend(0, 80 + (S + DOWN) * rows, WIDTH, 40, 1)
plot @BLANK, keyentry with boxes fs solid noborder fc rgb STABLE title 'measured: does not grow', \
     keyentry with lines lt 1 lc rgb '#000000' lw 2.4 title '|R(z)| = 1', \
     keyentry with lines lt 2 lw 1.2 title 'the equation: decays on the left'
unset multiplot
set output

eval names_of('oscillator')
if (words(names)) {
    columns = words(names) < 2 ? 1 : words(names) < 5 ? 2 : 3
    rows = (words(names) + columns - 1) / columns
    W = 360; H = 210
    eval set_map('oscillator', '', W, H, DOWN)
    eval map_style
    set multiplot
    eval heading('Where steps of the damped oscillator do not grow', \
        'q″ = −ω²q − 2ζωq′, by steps of the real code')
    do for [i = 1:words(names)] {
        eval trace('oscillator', i)
        eval panel(65 + (W + 40) * ((i - 1) % columns), 90 + (H + DOWN) * ((i - 1) / columns), W, H)
        set title '{/:Bold '.word(names, i).'}'.remark(word(names, i)) offset 0, -0.6
        set xrange [-0.06:4.06]; set yrange [-0.03:2.03]; set xtics 1; set ytics 0.5
        set xlabel 'ωh' offset 0, 0.6
        set ylabel leftmost((i - 1) % columns == 0) ? 'ζ' : '' offset 1, 0
        eval map('oscillator', i)
        eval heading_done
    }
    eval legend(0, 80 + (H + DOWN) * rows, WIDTH, 40, 1)
    plot @BLANK, keyentry with boxes fs solid noborder fc rgb STABLE title 'measured: does not grow', \
         keyentry with lines lt 1 lc rgb '#000000' lw 2.4 title '|R| = 1 on its faster growing mode'
    unset multiplot
    set output
}

# --- the longest stable step on wisps ---

AXIS = 1; VALUE = 2; NAME = 3; STEP = 4; UNSTABLE = 5; PREDICTED = 6
names = ''; all = ''
is_one(x) = place('"EA" "zeta" "nodes" "penalty_ratio"', strcol(AXIS))
take(x) = (all = with_name(all, strcol(AXIS)), names = with_name(names, strcol(NAME)))
stats table('limits') using (is_one(0) ? take(0) : 0, 0) nooutput
title_of(axis) = axis eq 'EA' ? 'stiffness' : axis eq 'zeta' ? 'damping' : axis eq 'nodes' ? 'nodes' \
    : 'penalty ratio (with an envelope)'
label_of(axis) = axis eq 'EA' ? 'stretch stiffness EA (N)' \
    : axis eq 'zeta' ? 'ζ of the highest stretch mode' \
    : axis eq 'nodes' ? 'nodes of a wisp of 0.3 m' : 'stiffness across over along the half-line'
told = told_of('limits', 'stepper step:s unstable_step:s kind predicted:s')
if (words(all)) {
    W = 380; H = 270
    eval figure('limits', 90 + (W + 35) * (words(all) > 1 ? 2 : 1), 85 + (H + 85) * ((words(all) + 1) / 2) + 60)
    set multiplot
    eval heading('The longest stable step on a wisp', \
        'marks: bisected over 0.5 s of a swing; lines: by the eigenvalues of the wisp at its start (no line: any step, or no prediction)')
    do for [a = 1:words(all)] {
        axis = word(all, a)
        eval panel(80 + (W + 35) * ((a - 1) % 2), 85 + (H + 85) * ((a - 1) / 2), W, H)
        unset logscale; set xrange [*:*]; set yrange [*:*] # stats counts what is in them
        stats table('limits') using (strcol(AXIS) eq axis ? column(VALUE) : NaN) nooutput
        eval powers('y'); set logscale x
        set yrange [1e-6:0.1]
        set title '{/:Bold '.title_of(axis).'}' offset 0, -0.6
        set xlabel label_of(axis) offset 0, 0.4
        set ylabel leftmost(a % 2) ? 'step (s)' : '' offset 0, 0
        set format y a % 2 ? '10^{%T}' : ''
        set xrange [0.75 * STATS_min:1.33 * STATS_max]
        if (axis eq 'nodes') { set xtics (8, 11, 16, 22, 30, 40) } else { set xtics autofreq }
        is_here(m) = strcol(AXIS) eq axis && strcol(NAME) eq word(names, m)
        if (SHOWN) { plot for [m = 1:words(names)] table('limits') \
                using (is_here(m) ? column(VALUE) : NaN):(column(PREDICTED)) \
                with lines lt style_of(word(names, m)), \
             for [m = 1:words(names)] '' \
                using (is_here(m) ? column(VALUE) : NaN):(column(STEP)) \
                with points lt style_of(word(names, m)) ps size_of(m), \
             for [k = 1:has_tips] '' using (strcol(AXIS) eq axis ? column(VALUE) : NaN):(column(STEP)) \
                :(tip_of(told)) @TIP }
        eval heading_done
    }
    eval legend(0, 75 + (H + 85) * ((words(all) + 1) / 2), WIDTH, 60, 2)
    plot @BLANK, for [m = 1:words(names)] keyentry with linespoints lt style_of(word(names, m)) \
        title word(names, m)
    unset multiplot
    set output
}

# --- what is left of an undamped oscillator ---

PERIOD = 3; DAMPING = 4; SHIFT = 5; DAMPING_THEORY = 6; SHIFT_THEORY = 7
eval names_of('damping')
W = 330; H = 340
GAP = 80
eval figure('damping', 70 + (W + GAP) * 3, 95 + H + 150)
set multiplot
eval heading('Stable is not accurate: what an undamped oscillator does', \
    'marks: by steps of the real code; lines: |R(iωh)| and arg R(iωh); adaptive methods at rtol 10^{−2} to 10^{−8}')
told = told_of('damping', 'stepper setting steps_per_period damping frequency_shift')
LOW = 1e-9; seen = '' # who is nowhere above it has no mark
stats table('damping') using (abs(column(DAMPING)) > LOW || abs(column(SHIFT)) > LOW \
    ? (seen = with_name(seen, strcol(1)), 0) : 0, 0) nooutput
array what[3] = ['damps it', 'drives it', 'shifts its frequency']
do for [p = 1:3] {
    eval panel(85 + (W + GAP) * (p - 1), 90, W, H)
    set logscale x; eval powers('y')
    set xrange [2.5:300]; set yrange [LOW:1]
    set xtics (3, 10, 30, 100, 300)
    set title '{/:Bold '.what[p].'}' offset 0, -0.6
    set xlabel 'steps to the period'.(paper eq '' ? ' (of adaptive ones the mean)' : '') offset 0, 0.4
    set ylabel p == 1 ? 'damping of the method''s own, of critical' : p == 2 ? 'the same, negative: it grows' \
        : '|frequency / true one − 1|' offset 0.5, 0
    part(x) = p == 1 ? x : p == 2 ? -x : abs(x)
    shown(x) = part(x) > 0 ? part(x) : NaN
    m_column = p < 3 ? DAMPING : SHIFT; t_column = p < 3 ? DAMPING_THEORY : SHIFT_THEORY
    is_here(m) = strcol(1) eq word(names, m)
    if (SHOWN) { plot for [m = 1:words(names)] table('damping') \
            using (is_here(m) ? column(PERIOD) : NaN):(shown(column(t_column))) \
            with lines lt style_of(word(names, m)), \
         for [m = 1:words(names)] '' \
            using (is_here(m) ? column(PERIOD) : NaN):(shown(column(m_column))) \
            with points lt style_of(word(names, m)) ps size_of(m), \
         for [k = 1:has_tips] '' using (strcol(1) eq 'stepper' ? NaN : column(PERIOD)):(shown(column(m_column))) \
            :(tip_of(told)) @TIP }
    eval heading_done
}
eval legend(0, 80 + H + 70, WIDTH, 80, 1)
plot @BLANK, for [m = 1:words(names)] keyentry with linespoints lt style_of(word(names, m)) \
    title word(names, m).(place(seen, word(names, m)) ? '' : ': none')
unset multiplot
set output
