# How fast it is: whole scenes in multiples of real time, cost along wisps, what a step costs, and
# what others need for the same.
load plots.'/style.gp'
eval require('scenes steps sizes peers')

MARK = '#0072B2'
TWO = MARK.' #D55E00'
second(text) = text eq 'best' ? 'best method' : "the thesis's recipe"

# --- rows of each panel, from top to bottom ---

rows = 0
array row_label[64]
stats table('scenes') using (strcol(1) eq 'target' ? 0 : (rows = rows + 1, row_label[rows] = \
    sprintf('%g mm, %s, %d thread%s', 1e3 * $1, strcol(3), $7, $7 > 1 ? 's' : ''), 0)) nooutput
methods = ''
stats table('steps') using (strcol(1) eq 'scene' ? 0 : (methods = with_name(methods, strcol(2)), 0)) nooutput
stepped = methods
who = ''; questions = ''
stats table('peers') using (strcol(1) eq 'question' ? 0 : (who = with_name(who, strcol(2)), \
    questions = with_name(questions, strcol(1)), 0)) nooutput
configurations = ''
stats table('sizes') using (strcol(1) eq 'wisps' ? (configurations = with_name(configurations, strcol(3)), 0) : 0) nooutput
row_at(list, name) = words(list) + 1 - place(list, name)
tics_of(list, i) = i > words(list) ? '' : (i > 1 ? ', ' : '').'"'.word(list, i).'" '.row_at(list, word(list, i)) \
    .tics_of(list, i + 1)

LEFT = 200; PANEL = 290; RIGHT = 720
TALL = 24
height_of(n) = TALL * n + 30
upper = height_of(rows > 9 ? rows : 9); lower = height_of(words(methods) > words(who) ? words(methods) : words(who))
eval figure('speed', RIGHT + PANEL + 30, upper + lower + 360)
set multiplot
eval heading('How fast, and beside whom', 'medians and quartiles of repeated measurements in one process, no frames written')

# --- whole scenes ---

eval panel(LEFT, 95, PANEL, upper)
set label 3 '{/:Bold how many times as fast as real time}' at graph 0, graph 1 offset character 0, 0.7 left
set logscale x; set xrange [0.5:100]; set xtics (0.5, 1, 2, 5, 10, 20, 50, 100)
set yrange [0.4:rows + 0.6]
unset ytics; set ytics nomirror ()
do for [r = 1:rows] { set ytics add (row_label[r] rows + 1 - r) }
set arrow 1 from 1, graph 0 to 1, graph 1 nohead lc rgb GREY dt (4, 3)
set bars 0
told = told_of('scenes', heads_of('scenes'))
n = 0
if (SHOWN) { plot table('scenes') using (strcol(1) eq 'target' ? NaN : $8):(n = n + 1, rows + 2 - n):9:10 \
        with xerrorbars pt 7 ps 0.9 lw 1.6 lc rgb MARK, \
     (n = 0, 1 / 0) notitle, \
     for [k = 1:has_tips] '' using (strcol(1) eq 'target' ? NaN : $8):(n = n + 1, rows + 2 - n):(tip_of(told)) @TIP }
eval heading_done
unset arrow 1; unset label 3

# --- along wisps ---

eval panel(RIGHT, 95, PANEL, upper)
set label 3 '{/:Bold along the number of wisps}' at graph 0, graph 1 offset character 0, 0.7 left
set xrange [0.7:*]; set yrange [*:*]; set xtics auto; unset ytics; set ytics nomirror auto
eval powers('x'); eval powers('y')
set xlabel 'wisps' offset 0, 0.4
set ylabel 'ns a wisp and simulated second'
set datafile missing NaN # curves go on over other configurations' rows
is_of(name) = strcol(1) eq 'wisps' && strcol(3) eq name
threads(c) = word(word(configurations, c), 2)
at_threads(c, n) = is_of(word(configurations, c)) && threads(c) eq n ? column(2) : NaN
told = told_of('sizes', heads_of('sizes'))
if (SHOWN) { plot for [c = 1:words(configurations)] table('sizes') using (at_threads(c, '1')):4:5:6 \
        with yerrorlines lt style_of(word(word(configurations, c), 1)) dt solid, \
     for [c = 1:words(configurations)] '' using (at_threads(c, '2')):4:5:6 \
        with yerrorlines lt style_of(word(word(configurations, c), 1)) dt (4, 3), \
     for [k = 1:has_tips] '' using (strcol(1) eq 'wisps' ? column(2) : NaN):4:(tip_of(told)) @TIP }
unset label 3; set datafile missing; set format '%h'; unset logscale; unset mxtics; unset mytics

eval legend(RIGHT, 95 + upper + 60, PANEL, 60, 2)
methods = ''
do for [c = 1:words(configurations)] { methods = with_name(methods, word(word(configurations, c), 1)) }
plot @BLANK, for [m = 1:words(methods)] keyentry with linespoints lt style_of(word(methods, m)) \
        dt solid title word(methods, m), \
     keyentry with lines lc rgb GREY lw 1.7 dt (4, 3) title '2 threads'
methods = stepped
eval page

# --- steps ---

below = 95 + upper + 150
eval panel(LEFT, below, PANEL, lower)
set label 3 '{/:Bold what a step costs, in steps of explicit Euler}' at graph 0, graph 1 offset character 0, 0.7 left
set logscale x; set xrange [0.5:100]; set xtics nomirror (0.5, 1, 2, 5, 10, 20, 50, 100)
set yrange [0.4:words(methods) + 0.6]
unset ytics; unset ylabel; unset xlabel
eval 'set ytics nomirror ('.tics_of(methods, 1).')'
told = told_of('steps', heads_of('steps'))
if (SHOWN) { plot table('steps') using (strcol(1) eq 'swing' ? $6 : NaN):(row_at(methods, strcol(2))):7:8 \
        with xerrorbars pt 7 ps 0.9 lw 1.6 lc rgb MARK, \
     '' using (strcol(1) eq 'swing-envelope' ? $6 : NaN):(row_at(methods, strcol(2))):7:8 \
        with xerrorbars pt 6 ps 0.9 lw 1.6 lc rgb '#D55E00', \
     for [k = 1:has_tips] '' using (place('"swing" "swing-envelope"', strcol(1)) ? $6 : NaN) \
        :(row_at(methods, strcol(2))):(tip_of(told)) @TIP }
unset label 3

# --- peers ---

eval panel(RIGHT, below, PANEL, lower)
set label 3 '{/:Bold the same error, over the cheapest here}' at graph 0, graph 1 offset character 0, 0.7 left
set xrange [0.8:300]; set xtics nomirror (1, 2, 5, 10, 20, 50, 100, 200)
set yrange [0.4:words(who) + 0.6]
unset ytics
eval 'set ytics nomirror ('.tics_of(who, 1).')'
set arrow 1 from 1, graph 0 to 1, graph 1 nohead lc rgb GREY dt (4, 3)
told = told_of('peers', heads_of('peers'))
if (SHOWN) { plot for [k = 1:words(questions)] table('peers') \
        using (strcol(1) eq word(questions, k) ? $8 : NaN):(row_at(who, strcol(2))):9:10 \
        with xerrorbars pt 8 - k ps 0.9 lw 1.6 lc rgb word(TWO, k), \
     for [k = 1:has_tips] '' using (place(questions, strcol(1)) ? $8 : NaN):(row_at(who, strcol(2))):(tip_of(told)) @TIP }
unset label 3; unset arrow 1

eval legend(LEFT, below + lower + 50, PANEL, 40, 2)
plot @BLANK, keyentry with points pt 7 ps 0.9 lc rgb MARK title 'without envelope', \
     keyentry with points pt 6 ps 0.9 lc rgb '#D55E00' title 'with envelope'
eval legend(RIGHT, below + lower + 50, PANEL, 40, 2)
plot @BLANK, for [k = 1:words(questions)] keyentry with points pt 8 - k ps 0.9 \
        lc rgb word(TWO, k) title word(questions, k)
unset multiplot
set output
