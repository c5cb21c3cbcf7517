# How exactly each treatment keeps the envelope's samples on their lines, and what that costs.
load plots.'/style.gp'
eval require('scenes')

# Treatments are no steppers and have styles of their own.
kinds = '"projection" "no envelope" "generalised"'
set linetype 11 lc rgb '#0072B2' dt solid pt 9 ps 0.9 lw 1.7  # penalty
set linetype 12 lc rgb '#D55E00' dt (12,4) pt 7 ps 1.0 lw 1.7 # projection
set linetype 13 lc rgb '#555555' dt (2.5,2.5) pt 5 ps 1.0 lw 1.7 # no envelope
set linetype 14 lc rgb '#009E73' dt (10,3,2,3) pt 13 ps 1.1 lw 1.7 # generalised
dark(k) = word('#A84A00 #555555 #006B4E', k)

# columns of a scene's table
END = 3; DOUBT = 8; LIMITED = 10
is_penalty(name) = word(name, 1) eq 'penalty'

scene_files = ''; scene_names = ''; ends = ''
stats table('scenes') using (strcol(1) eq 'file' ? 0 \
    : (scene_files = scene_files.quoted(strcol(1)), scene_names = scene_names.quoted(strcol(2)), \
       ends = ends.' '.strcol(3)), 0) nooutput

do for [s = 1:words(scene_files)] {
    scene = word(scene_files, s)
    eval figure(scene, 1100, 630)
    doubt = NaN; least = 1e300; most = 0
    low = 1e300; high = 0
    array error_of[3]; do for [k = 1:3] { error_of[k] = NaN }
    unset logscale; set autoscale
    stats table(scene) using (strcol(1) eq 'name' ? 0 : (doubt = column(DOUBT), \
        least = column(END) < least ? column(END) : least, \
        most = column(END) > most ? column(END) : most, \
        low = $2 < low ? $2 : low, high = $2 > high ? $2 : high), 0) nooutput
    do for [k = 1:3] {
        stats table(scene) using (strcol(1) eq word(kinds, k) \
            ? error_of[k] = column(END) : 0, 0) nooutput
    }
    bottom = (doubt < least ? doubt : least) / 2
    told = told_of(scene, 'name ratio end:m uncertainty:m rk4_step:s rk4_error:m rk4_evaluations rk4_cpu_median:s')
    set multiplot
    # The shipped scene has the experiment's name.
    name = word(scene_names, s) eq 'treatments' ? '' : ': '.escaped(word(scene_names, s))
    eval heading('Treatments of the envelope'.name, \
        sprintf('rms distance of the free nodes from the exact constrained motion, after %s s; ', \
        word(ends, s)).'reference solutions: no integrator has a part in it')
    do for [p = 1:3] {
        eval panel(95 + 345 * (p - 1), 75, 300, 365)
        eval powers('x'); eval powers('y')
        set yrange [bottom:4 * most]
        if (!leftmost(p == 1)) { set format y '' }
        if (p > 1) { set autoscale x; set offsets graph 0.05, graph 0.05, 0, 0 } \
        else { set xrange [0.6 * low:1.6 * high] }
        set xlabel p == 1 ? 'penalty ratio' : p == 2 ? 'force evaluations' \
            : 'CPU time (s)'.SPREAD offset 0, 0.3
        set ylabel leftmost(p == 1) ? 'treatment error (m)' : '' offset 0, 0
        set xtics offset 0, 0.3
        unset label 3; unset arrow
        do for [k = 1:3] { unset label 10 + k }
        set arrow 1 from graph 0, first doubt to graph 1, first doubt nohead lt 2 lw 1.2
        if (p == 1) {
            set label 3 'uncertainty of the exact motion' at graph 0.02, first doubt left \
                offset 0, 0.5 font ',11' textcolor rgb GREY
            do for [k = 1:3] {
                if (error_of[k] == error_of[k]) {
                    set arrow 10 + k from graph 0, first error_of[k] to graph 1, first error_of[k] \
                        nohead lt 11 + k
                    set label 10 + k word(kinds, k) at graph 0.99, first error_of[k] right \
                        offset 0, 0.6 font ',11' textcolor rgb dark(k)
                }
            }
            if (SHOWN) { plot table(scene) using (is_penalty(strcol(1)) ? $2 : NaN):END with linespoints lt 11, \
                 '' using (is_penalty(strcol(1)) && column(LIMITED) == 1 ? $2 : NaN):END \
                    with points lt 11 lc rgb '#BBBBBB', \
                 for [n = 1:has_tips] '' using (is_penalty(strcol(1)) ? $2 : NaN):END:(tip_of(told)) @TIP }
        } else {
            tight = p == 2 ? 11 : 12; rk4 = p == 2 ? 23 : 24; spread = p == 3
            set bars 0
            if (SHOWN) { plot for [c in sprintf('%d %d', tight, rk4)] table(scene) \
                    using (is_penalty(strcol(1)) ? column(int(c)) : NaN):END \
                    with linespoints lt 11 pt (int(c) == tight ? 8 : 9), \
                 for [c in sprintf('%d %d', tight, rk4)] '' \
                    using (is_penalty(strcol(1)) && column(LIMITED) == 1 ? column(int(c)) : NaN):END \
                    with points lt 11 pt (int(c) == tight ? 8 : 9) lc rgb '#BBBBBB', \
                 for [k = 1:3] '' using (strcol(1) eq word(kinds, k) ? column(tight) : NaN):END \
                    with points lt (11 + k) pt int(word('6 4 12', k)), \
                 for [k = 1:3] '' using (strcol(1) eq word(kinds, k) ? column(rk4) : NaN):END \
                    with points lt (11 + k), \
                 '' using (spread ? column(tight) : NaN):END \
                    :(column(tight + spread)):(column(tight + 2 * spread)) \
                    with xerrorbars lt 1 lw 1 pt 0, \
                 '' using (spread ? column(rk4) : NaN):END \
                    :(column(rk4 + spread)):(column(rk4 + 2 * spread)) \
                    with xerrorbars lt 1 lw 1 pt 0, \
                 for [n = 1:has_tips] for [c in sprintf('%d %d', tight, rk4)] '' \
                    using (strcol(1) eq 'name' ? NaN : column(int(c))):END:(tip_of(told)) @TIP }
        }
        eval heading_done
    }
    unset offsets
    eval legend(0, 515, 1100, 105, 4)
    plot @BLANK, keyentry with linespoints lt 11 title 'penalty, ratio rising downwards', \
         keyentry with points lt 11 lc rgb '#BBBBBB' title 'within ten times the uncertainty', \
         keyentry with points lt 12 title 'projection', keyentry with points lt 13 title 'no envelope', \
         keyentry with points lt 14 title 'generalised', \
         keyentry with points lt 1 pt 7 title 'filled: rk4 to a tenth of the error', \
         keyentry with points lt 1 pt 6 title 'open: the reference solution'
    unset multiplot
}
set output
