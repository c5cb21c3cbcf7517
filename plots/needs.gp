# What each thing changes in a scene's result, and what the model costs without it.
load plots.'/style.gp'
eval require('needs smallest')

# columns of the table
SCENE = 1; THING = 2; OPTION = 3; RMS = 4; LARGEST = 5; RATIO = 10; VERDICT = 12; MODEL = 13
eval names_of('smallest')
scenes = ''
do for [n in names] { if (n ne 'scene') { scenes = with_name(scenes, n) } }

# Of the row `smallest` of a scene: what perturbed starts change, m; how much is compared, s.
PERTURBED = 22; SCATTERED = 23; COMPARED = 13
told = told_of('needs', 'option thing change_rms:m change_largest:m cpu_median:s cost_ratio verdict')
NEEDED = '#D55E00'; ENOUGH = '#0072B2'; UNKNOWN = '#7F7F7F'
colour_for(v) = v eq 'needed' || v eq 'failed' ? NEEDED : v eq 'not needed' ? ENOUGH : UNKNOWN
mark_for(v) = v eq 'needed' ? 7 : v eq 'not needed' ? 6 : v eq 'failed' ? FAILED : 4

ROWS = 80
array thing[ROWS]; array option[ROWS]; array verdict[ROWS]; array rms[ROWS]; array largest[ROWS]
array ratio[ROWS]; array y[ROWS]

do for [s = 1:words(scenes)] {
    scene = word(scenes, s)
    n = 0; noise = NaN; compared = ''
    unset logscale; set autoscale
    stats table('smallest') using (strcol(SCENE) eq scene ? (noise = column(PERTURBED) > column(SCATTERED) \
        ? column(PERTURBED) : column(SCATTERED), compared = strcol(COMPARED), 0) : 0, 0) nooutput
    full = ''; smallest = ''
    stats table('needs') using (strcol(SCENE) eq scene ? (strcol(THING) eq 'full' \
        ? full = strcol(MODEL) : strcol(OPTION) eq 'smallest model' ? smallest = strcol(MODEL) : '', \
        0) : 0, 0) nooutput
    stats table('needs') using (strcol(SCENE) eq scene && strcol(THING) ne 'full' \
        ? (n = n + 1, thing[n] = strcol(THING), option[n] = strcol(OPTION), \
           verdict[n] = strcol(VERDICT), rms[n] = column(RMS), \
           largest[n] = column(LARGEST), ratio[n] = column(RATIO), 0) : 0, 0) nooutput
    # From the top down, with a gap between things.
    at = 0; most = 1e-2; costliest = 1
    do for [i = 1:n] {
        at = at - 1 - (i > 1 && thing[i] ne thing[i > 1 ? i - 1 : 1] ? 0.7 : 0)
        y[i] = at
        if (largest[i] > most) { most = largest[i] }
        if (ratio[i] > costliest) { costliest = ratio[i] }
    }
    LEAST = 1e-3 # mm; what changes less is drawn there
    top = 2.5 * 1e3 * most; failed_at = top * 1.6
    shown(x) = x == x ? (1e3 * x > LEAST ? 1e3 * x : LEAST) : failed_at
    height = 244 + 20 * (-at)
    eval figure(scene, 1000, height)
    set multiplot
    do for [p = 1:2] {
        eval panel(p == 1 ? 270 : 710, 132, p == 1 ? 400 : 270, height - 244)
        unset object; unset label; unset arrow
        if (p == 1) {
            eval heading('What does the scene '.escaped(scene).' need?', \
                sprintf('one thing at a time otherwise than in its full model, over %.3g s', real(compared)))
            set label 4 paper ne '' ? '' : '{/:Bold Full:} '.full at screen 12. / WIDTH, screen below(66) left \
                font ',12'
            set label 5 paper ne '' ? '' : (smallest eq full ? '{/:Bold Nothing less is within 1 mm of it}' \
                : smallest eq '' ? 'It failed.' : '{/:Bold Enough for 1 mm:} '.smallest) \
                at screen 12. / WIDTH, screen below(86) left font ',12'
        }
        set yrange [at - 0.8:-0.2]
        unset ytics
        set xtics offset 0, 0.3
        if (p == 1) {
            set logscale x; set format x '%g'; unset mxtics
            set xrange [0.7 * LEAST:failed_at * 1.6]
            set xtics (LEAST, 0.01, 0.1, 1, 10, 100, 1000)
            set xlabel 'change in the result (mm)'.(paper eq '' ? ': rms ●○, line to the largest' : '') offset 0, 0.4
            set arrow 1 from 1, graph 0 to 1, graph 1 nohead lt 2 lw 1.6 front
            set label 3 '1 mm' at 1, graph 1 center offset 0, 0.5 font ',11'
            if (1e3 * noise > LEAST) {
                set object 1 rectangle from graph 0, graph 0 to 1e3 * noise, graph 1 behind \
                    fillcolor rgb '#EEEEEE' fillstyle solid noborder
            }
        } else {
            unset logscale; set format x '%g'; set xtics autofreq
            set xrange [0:1.15 * costliest]
            set xlabel 'CPU time over that of the full model' offset 0, 0.4
            set arrow 1 from 1, graph 0 to 1, graph 1 nohead lt 2 lw 1.6 front
            set label 3 'full model' at 1, graph 1 center offset 0, 0.5 font ',11'
        }
        do for [i = 1:n] {
            together = thing[i] eq 'together'
            face = together ? ':Bold' : ''
            colour_here = colour_for(verdict[i]); mark_here = mark_for(verdict[i])
            share = verdict[i] eq 'needed' ? 0.9 : 0.35
            if (p == 1) {
                set label 100 + 2 * i option[i] at graph 0, first y[i] right offset -1.2, 0 \
                    font face noenhanced
                if (i == 1 || thing[i] ne thing[i > 1 ? i - 1 : 1]) {
                    caption = together ? '' : thing[i]
                    set label 101 + 2 * i caption at screen 12. / WIDTH, first y[i] \
                        left textcolor rgb GREY
                }
                if (rms[i] == rms[i]) {
                    set arrow 100 + i from shown(rms[i]), y[i] to shown(largest[i]), y[i] nohead \
                        lc rgb colour_here lw 1.4
                }
                caption = rms[i] == rms[i] ? '' : verdict[i]
                set label 300 + i caption at shown(rms[i]), y[i] right \
                    offset -1.5, 0 font ',11' textcolor rgb GREY \
                    point pt mark_here ps 1.1 lw 1.6 lc rgb colour_here
            } else {
                if (ratio[i] == ratio[i]) {
                    set object 100 + i rectangle from 0, y[i] - 0.32 to ratio[i], y[i] + 0.32 \
                        fillcolor rgb colour_here \
                        fillstyle solid share noborder
                    # Where the line of the full model would go through it, it stands behind the line.
                    text_at = ratio[i] < 1 && ratio[i] + 0.14 * costliest > 1 ? 1 : ratio[i]
                    set label 100 + i sprintf(ratio[i] < 0.095 ? '%.2f' : '%.1f', ratio[i]) \
                        at text_at, y[i] left offset 0.4, 0 font ',11'
                }
            }
        }
        r = 0 # rows of the table come in the order of the arrays
        is_row(x) = strcol(SCENE) eq scene && strcol(THING) ne 'full'
        across(i) = p == 1 ? shown(rms[i]) : ratio[i]
        if (SHOWN) { plot NaN, for [k = 1:has_tips] table('needs') using (is_row(0) ? (r = r + 1, across(r)) : NaN) \
            :(is_row(0) ? y[r] : NaN):(tip_of(told)) @TIP }
        eval heading_done
    }
    unset object; unset label; unset arrow
    drawn = '' # the legend has the marks that are there
    do for [i = 1:n] { drawn = with_name(drawn, sprintf('%d', mark_for(verdict[i]))) }
    when(mark, words) = place(drawn, sprintf('%d', mark)) ? words : ''
    eval legend(0, height - 42, WIDTH, 30, 1)
    plot @BLANK, keyentry with points pt 7 ps 1.1 lc rgb NEEDED title when(7, 'needed: changes more than 1 mm'), \
         keyentry with points pt 6 ps 1.1 lw 1.6 lc rgb ENOUGH title when(6, 'not needed'), \
         keyentry with points pt 4 ps 1.1 lw 1.6 lc rgb UNKNOWN title when(4, 'no more than perturbed starts (grey)'), \
         keyentry with points pt FAILED ps 1.1 lw 1.6 lc rgb NEEDED title when(FAILED, 'fails')
    unset multiplot
}
set output
