# What could be done before the thesis, and what it changed; and how far a step carries news.
load plots.'/style.gp'
eval require('recipes eras film map stiffnesses news arrivals rates')

eras = '"Rosenblum 1991" "Anjyo 1992" "Baraff-Witkin 1998" "Plante 1999" "today"'
said = '"Rosenblum 1991: explicit Euler" "Anjyo 1992: segments by themselves" "Baraff and Witkin 1998: implicit Euler" "Plante 1999: Euler with projection" "today: BDF2, stretching implicit"'
INK = '"#CC79A7" "#E69F00" "#009E73" "#D55E00" "#0072B2"'
marks = '5 9 13 7 11'
do for [e = 1:5] {
    eval sprintf('set linetype %d lc rgb %s dt solid pt %s ps 0.9 lw 1.8', 30 + e, \
        '"'.word(INK, e).'"', word(marks, e))
}
count = words(eras)

# columns
RATE = 4; OWN = 5; STATUS = 6; ERROR = 8; MEDIAN = 11          # of recipes
E_RATE = 4; E_STATUS = 5; E_FAILED = 6; E_ERROR = 7; E_APART = 9 # of eras
is(e) = strcol(1) eq word(eras, e)
mm(x) = 1e3 * x

# --- error against cost ---

eval figure('recipes', 900, 620)
eval heading('One hair by the recipes of their times', \
    'rms distance from the exact motion of swing, by CPU time of a simulated second; large: the rate that its authors chose; ×: failed')
eval panel(85, 70, 785, 415)
eval powers('x')
set logscale y; set format y '%g'; unset mytics
set xrange [6e-6:30]; set yrange [1e-4:4000]
set xlabel 'CPU time (s)' offset 0, 0.3; set ylabel 'distance (mm)' offset 1, 0
set ytics (0.0001, 0.001, 0.01, 0.1, 1, 10, 100)
top(e) = 2400 / 1.75 ** (e - 1) # where crosses are, so that they do not hide each other
set arrow 1 from 1, graph 0 to 1, graph 1 nohead lt 2 lw 1.2
set label 3 'real time' at 1, graph 0.02 left offset 0.5, 0.3 font ',11' textcolor rgb GREY
apart_1 = 0; apart_2 = 0
stats table('eras') using (is(1) ? (apart_1 = mm(column(E_APART)), 0) : is(2) ? (apart_2 = mm(column(E_APART)), 0) : 0, 0) nooutput
set arrow 2 from graph 0, first apart_1 to graph 1, first apart_1 nohead lc rgb word(INK, 1) dt (2,4) lw 1.4
set arrow 3 from graph 0, first apart_2 to graph 1, first apart_2 nohead lc rgb word(INK, 2) dt (2,4) lw 1.4
set label 4 'exact motion of Anjyo''s hair' at graph 0.99, first apart_2 right offset 0, 0.55 font ',11' textcolor rgb GREY
set label 5 'exact motion of Rosenblum''s' at 0.6, first apart_1 right offset 0, -0.6 font ',11' textcolor rgb GREY
eval own_key(count, 36, \
    'set key at screen 0.5, screen 0.075 center center horizontal Left reverse maxrows 3 samplen 3 width 2')
# Who never finishes has crosses alone, in the legend too.
array finishes[count]
do for [e = 1:count] {
    finishes[e] = 0
    stats table('recipes') using (is(e) && strcol(STATUS) eq 'finished' ? (finishes[e] = 1, 0) : 0, 0) nooutput
}
told = told_of('recipes', 'method stepper rate:Hz status failure_time:s error:m cpu_median:s evaluations')
if (SHOWN) { plot for [e = 1:count] table('recipes') using (is(e) && strcol(STATUS) eq 'finished' ? column(MEDIAN) : NaN):(mm(column(ERROR))) \
        with linespoints lt 30 + e title finishes[e] ? word(said, e) : '', \
     for [e = 1:count] '' using (is(e) && strcol(STATUS) ne 'finished' ? column(MEDIAN) : NaN):(top(e)) \
        with points pt FAILED ps 0.9 lc rgb word(INK, e) lw 1.6 title finishes[e] ? '' : word(said, e), \
     for [e = 1:count] '' using (is(e) && column(OWN) == 1 && strcol(STATUS) eq 'finished' ? column(MEDIAN) : NaN):(mm(column(ERROR))) \
        with points pt int(word(marks, e)) ps 2 lc rgb word(INK, e), \
     for [e = 1:count] '' using (is(e) && column(OWN) == 1 && strcol(STATUS) ne 'finished' ? column(MEDIAN) : NaN):(top(e)) \
        with points pt FAILED ps 2 lc rgb word(INK, e) lw 2.4, \
     for [e = 1:count] '' using (is(e) && column(OWN) == 1 && strcol(STATUS) eq 'finished' ? column(MEDIAN) : NaN):(mm(column(ERROR))):(sprintf('%.0f Hz', column(RATE))) \
        with labels left offset 1.2, 0.5 font ',11' textcolor rgb word(INK, e), \
     for [e = 1:count] '' using (is(e) && column(OWN) == 1 && strcol(STATUS) ne 'finished' ? column(MEDIAN) : NaN):(top(e)):(sprintf('%.0f Hz', column(RATE))) \
        with labels left offset 0.4, 1.05 font ',11' textcolor rgb word(INK, e), \
     for [n = 1:has_tips] for [e = 1:count] '' using (is(e) ? column(MEDIAN) : NaN) \
        :(strcol(STATUS) eq 'finished' ? mm(column(ERROR)) : top(e)):(tip_of(told)) @TIP }
set output

# --- the film ---

panels = 0
stats table('film') using (panels = $2 > panels ? $2 : panels, 0) nooutput
panels = panels + 1
array when[panels]
stats table('film') using (strcol(1) eq 'exact' ? (when[$2 + 1] = $3, 0) : 0, 0) nooutput
LEFT = 168; ACROSS = 108; DOWN = 118; HEAD = 84
eval figure('film', LEFT + panels * ACROSS + 12, HEAD + count * DOWN + 10)
if (format ne 'svg') { # a miter at a hair's first point would be a spike
    set output
    set terminal pngcairo rounded font FONT.',13'
    set output out.'/film.'.format
}
set multiplot
unset border; unset tics; unset grid; unset key
eval heading('The same swing by five recipes', \
    'one hair of 30 cm let go from the horizontal; grey: its exact motion; each at the rate that its authors chose, today''s at the coarsest within 1 mm')
rate_text = ''; status_text = ''
do for [e = 1:count] {
    rate = NaN; failed = NaN; distance = NaN
    stats table('eras') using (is(e) ? (rate = column(E_RATE), failed = column(E_FAILED), distance = mm(column(E_ERROR)), 0) : 0, 0) nooutput
    do for [p = 1:panels] {
        eval panel(LEFT + (p - 1) * ACROSS, HEAD + (e - 1) * DOWN, ACROSS - 6, DOWN - 8)
        set xrange [-0.075:0.325]; set yrange [-0.345:0.0775]
        set object 1 rectangle from graph 0, graph 0 to graph 1, graph 1 fillstyle empty border lc rgb '#DDDDDD' behind
        if (p == 1) {
            set label 11 '{/:Bold '.escaped(word(eras, e)).'}' at screen 12. / WIDTH, graph 0.85 left
            set label 12 (rate == rate ? sprintf('%.0f Hz', rate) : 'no rate') at screen 12. / WIDTH, graph 0.66 left textcolor rgb GREY
            set label 13 (failed == failed ? sprintf('fails at %.3f s', failed) : distance < 10 ? sprintf('%.2f mm', distance) : sprintf('%.0f mm', distance)) \
                at screen 12. / WIDTH, graph 0.49 left textcolor rgb GREY
        }
        if (e == 1) { set label 14 sprintf('%.2f s', when[p]) at graph 0.5, graph 1.1 center textcolor rgb GREY }
        if (failed == failed && when[p] > failed - 1e-9) {
            set label 15 '×' at graph 0.86, graph 0.2 center font ',30' textcolor rgb word(INK, e)
        }
        if (SHOWN) { plot table('film') using (strcol(1) eq 'exact' && $2 == p - 1 ? $5 : NaN):6 with lines lc rgb '#C4C4C4' dt solid lw 5, \
             '' using (is(e) && $2 == p - 1 ? $5 : NaN):6 with linespoints lc rgb word(INK, e) dt solid lw 2 pt 7 ps 0.35, \
             NaN }
        unset label; unset object
    }
}
unset multiplot
set output

# --- Rosenblum's hair by stiffness and rate ---

# columns of map and stiffnesses
M_STATE = 3; THEORY = 3
kinds = '"fine" "unstable" "limp" "both"'
meaning = '"right" "unstable" "hair stretches by more than a tenth" "both"'
fills = '"#BFE3D0" "#E9A58A" "#CFC3E3" "#B9919F"'
cells = 0; stiffnesses = 0; least = 1e300; most = 0; slowest = 1e300; fastest = 0
unset logscale; set autoscale
stats table('stiffnesses') using ($1 > 0 ? (stiffnesses = stiffnesses + 1, least = $1 < least ? $1 : least, most = $1 > most ? $1 : most, 0) : 0, 0) nooutput
stats table('map') using ($1 > 0 ? (cells = cells + 1, slowest = $2 < slowest ? $2 : slowest, fastest = $2 > fastest ? $2 : fastest, 0) : 0, 0) nooutput
wide = sqrt((most / least) ** (1. / (stiffnesses - 1)))
high = sqrt((fastest / slowest) ** (1. / (cells / stiffnesses - 1)))

eval figure('map', 900, 620)
eval heading('Rosenblum''s hair under explicit Euler', \
    'by stiffness and rate; each cell is a run of a second, judged by the exact motion of the same hair')
eval panel(95, 70, 775, 430)
eval powers('x'); eval powers('y'); unset grid
set xrange [least / wide:most * wide]; set yrange [slowest / high:fastest * high]
set xlabel 'stretch stiffness EA (N)' offset 0, 0.3; set ylabel 'rate (Hz)' offset 0.5, 0
eval own_key(5, 30, \
    'set key at screen 0.5, screen 0.055 center center horizontal Left reverse maxrows 1 samplen 2 width 1')
set style fill solid 1 border lc rgb '#FFFFFF'
set arrow 1 from graph 0, first 60 to graph 1, first 60 nohead front lc rgb '#000000' lw 2.2
set label 3 '60 Hz: Rosenblum et al. 1991' at graph 0.015, first 60 left offset 0, 0.6 front
set arrow 2 from 90, graph 0 to 90, graph 1 nohead front lt 2 lw 1.5
set label 4 'swing' at 90, graph 0.5 left offset 0.6, 0 front
set arrow 3 from 16800, graph 0 to 16800, graph 1 nohead front lt 2 lw 1.5
set label 5 'real hair' at 16800, graph 0.5 right offset -0.6, 0 front
if (SHOWN) { plot for [k = 1:4] table('map') using (strcol(M_STATE) eq word(kinds, k) ? $1 : NaN):2:($1 / wide):($1 * wide):($2 / high):($2 * high) \
        with boxxyerror lc rgb word(fills, k) lw 0.6 title word(meaning, k), \
     table('stiffnesses') using 1:THEORY with lines lc rgb '#000000' dt (8,4) lw 2 title 'nothing grows (linear theory)' }
set output

# --- how far a step carries news ---

# columns of arrivals and rates
NODE = 3; EVALUATIONS = 5
RATES_NEWS = 4; RATES_STABLE = 5
shown = '"euler|Rosenblum''s without hinges" "euler|Rosenblum''s" "euler|springs alone" "euler|skip springs" "rk4|skip springs" "implicit-euler|skip springs"'
who = '"Rosenblum 1991 without hinges, euler" "Rosenblum 1991, euler" "springs alone, euler" "skip springs, euler" "skip springs, rk4" "skip springs, implicit-euler"'
paint = '"#CC79A7" "#CC79A7" "#D55E00" "#D55E00" "#0072B2" "#009E73"'
dots = '4 5 6 7 9 13'
dashes = '2 1 2 1 1 1'
do for [s = 1:6] {
    eval sprintf('set linetype %d lc rgb "%s" dt %s pt %s ps 0.85 lw 1.8', 40 + s, word(paint, s), \
        int(word(dashes, s)) == 2 ? '(6,4)' : 'solid', word(dots, s))
}
eval names_of('rates')
eval figure('news', 1100, 640)
set multiplot
eval heading('How far does a step carry news?', \
    'left: a change at the tip of a hair of fifteen particles runs to the root; right: why the rates of explicit methods grow with the number of nodes')
eval panel(75, 90, 445, 370)
set title '{/:Bold which nodes have heard}' offset 0, -0.5
set xrange [-0.5:26.5]; set yrange [1.5:15.6]
set xlabel 'force evaluations since' offset 0, 0.3; set ylabel 'node (15: the tip)' offset 0.5, 0
set ytics (2, 5, 10, 15)
set arrow 1 from 15, graph 0 to 15, graph 1 nohead lt 2 lw 1.4
set label 3 "the thesis:\n“fifteen”" at 15, graph 0.93 left offset 0.5, 0 font ',11' textcolor rgb GREY
told = told_of('arrivals', 'method law node step evaluations')
if (SHOWN) { plot for [s = 1:6] table('arrivals') using (strcol(1).'|'.strcol(2) eq word(shown, s) ? column(EVALUATIONS) : NaN):(column(NODE)) \
    with linespoints lt 40 + s, \
    for [n = 1:has_tips] for [s = 1:6] '' using (strcol(1).'|'.strcol(2) eq word(shown, s) ? column(EVALUATIONS) : NaN) \
    :(column(NODE)):(tip_of(told)) @TIP }
unset arrow; unset label 3; set ytics nomirror out autofreq
eval heading_done
eval panel(610, 90, 470, 370)
set title '{/:Bold the rate at which an explicit method is stable}' offset 0, -0.5
set logscale xy; set format x '%g'; set format y "10^{%T}"; unset mxtics
set xrange [3.5:290]; set yrange [200:5e5]
set xtics (4, 6, 11, 21, 41, 81)
do for [k = 0:2] {
    set label 5 + k sprintf('%d node%s a step', 2 ** k, k ? 's' : '') at 92, 33500. / 2 ** k left \
        font ',11' textcolor rgb GREY
}
set xlabel 'nodes of a hair of 30 cm' offset 0, 0.3; set ylabel 'rate (Hz)' offset 1, 0
told = told_of('rates', 'method nodes stable_rate:Hz news_rate:Hz')
if (SHOWN) { plot for [m = 1:words(names)] table('rates') using (strcol(1) eq word(names, m) ? $2 : NaN):(column(RATES_STABLE)) \
        with linespoints lt style_of(word(names, m)), \
     for [m = 1:words(names)] '' using (strcol(1) eq word(names, m) ? $2 : NaN):(column(RATES_NEWS)) \
        with lines lc rgb colour_of(word(names, m)) dt (2,3) lw 1.6, \
     for [n = 1:has_tips] '' using (strcol(1) eq 'method' ? NaN : $2):(column(RATES_STABLE)):(tip_of(told)) @TIP }
unset logscale; unset title; unset label
eval legend(20, 520, 560, 110, 3)
plot @BLANK, for [s = 1:6] keyentry with linespoints lt 40 + s title word(who, s)
eval legend(600, 520, 490, 110, 3)
plot @BLANK, for [m = 1:words(names)] keyentry with linespoints lt style_of(word(names, m)) title word(names, m), \
    keyentry with lines lc rgb GREY dt (2,3) lw 1.6 title 'at which its news keeps up with the wave'
unset multiplot
set output
