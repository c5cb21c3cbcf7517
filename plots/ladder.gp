# What a millimetre costs each method along stretch stiffness, a panel for each kind of hair: where
# bending stiffens beside stretching, and how damping changes it.
load plots.'/style.gp'
eval require('ladder crossings')

# columns of the table
EA = 1; NAME = 3; SETTING = 4; ERROR = 6; CPU = 8; LEAST = 9; GREATEST = 10; STATUS = 13; LIMIT = 14; HAIR = 18; FIGURE = 19

figures = ''; names = ''; main_hair = ''
first = 1e300; last = 0; lowest = 1e300; highest = 0
is_row(x) = strcol(STATUS) eq 'reached' || strcol(STATUS) eq 'never'
# Rigid segments, of stiffness `inf`, stand beyond the stiffest hair of the first panel.
is_rigid(x) = strcol(EA) eq 'inf'
has_rigid = 0
in_all(x) = strcol(STATUS) eq 'reached' ? (lowest = column(LEAST) < lowest ? column(LEAST) : lowest, \
    highest = column(GREATEST) > highest ? column(GREATEST) : highest, 0) : 0
take(x) = (figures = with_name(figures, strcol(FIGURE)), names = with_name(names, strcol(NAME)), \
    in_all(0), is_rigid(0) ? (has_rigid = 1, 0) \
    : (main_hair = main_hair eq '' ? strcol(HAIR) : main_hair, \
       first = column(EA) < first ? column(EA) : first, \
       last = column(EA) > last ? column(EA) : last, 0))
stats table('ladder') using (is_row(0) ? take(0) : 0, 0) nooutput
if (last == 0 && !has_rigid) { exit error 'ladder: no method has a row' }
if (last == 0) { first = 1; last = 1 }
RIGID = 6. * last
if (highest == 0) { lowest = 1e-3; highest = 1 }

# What the thesis took has a name, the cheapest of rigid segments and where the first hair is stiffest, what becomes of it
# when its matrix has stretching alone, and then the best of each other method.
array cost[words(names)]
do for [m = 1:words(names)] {
    cost[m] = 1e300
    stats table('ladder') using (strcol(NAME) eq word(names, m) && strcol(STATUS) eq 'reached' \
        && strcol(HAIR) eq main_hair && column(EA) == last && column(CPU) < cost[m] \
        ? (cost[m] = column(CPU), 0) : 0) nooutput
}
method(name) = word(name, 1)
cheaper(m, k) = cost[k] < cost[m] || (cost[k] == cost[m] && k < m)
before(m) = sum [k = 1:words(names)] cheaper(m, k)
best_of_method(m) = 0 == sum [k = 1:words(names)] \
    (method(word(names, k)) eq method(word(names, m)) && cheaper(m, k))
chosen = place(names, 'euler') ? quoted('euler') : ''
best = 1e300; best_rigid = ''
stats table('ladder') using (is_rigid(0) && strcol(STATUS) eq 'reached' && column(CPU) < best \
    ? (best = column(CPU), best_rigid = strcol(NAME), 0) : 0, 0) nooutput
if (best_rigid ne '') { chosen = named(chosen, best_rigid) }
do for [b = 0:words(names) - 1] {
    do for [m = 1:words(names)] {
        if (before(m) == b && best_of_method(m)) {
            chosen = named(chosen, word(names, m))
            alone = method(word(names, m)).' stretch'
            if (b == 0 && place(names, alone)) { chosen = named(chosen, alone) }
        }
    }
}
eval part_names

is_here(hair, name) = strcol(HAIR) eq hair && strcol(NAME) eq name
cpu_at(hair, name, status) = is_here(hair, name) && strcol(STATUS) eq status ? column(EA) : NaN
cpu_of_rigid(name, status) = is_rigid(0) && strcol(NAME) eq name && strcol(STATUS) eq status \
    ? RIGID : NaN

# Every point, also of curves without a name.
place_here(hair, with_rigid) = !is_row(0) ? NaN : is_rigid(0) ? (with_rigid ? RIGID : NaN) \
    : strcol(HAIR) eq hair ? column(EA) : NaN
height_here(x) = strcol(STATUS) eq 'reached' ? column(CPU) : place(band, strcol(NAME)) ? row_of(strcol(NAME)) : NaN
told = told_of('ladder', 'method stretch_stiffness:N setting status error:m cpu_median:s missed_setting missed_outcome')

do for [f = 1:words(figures)] {
    hairs = ''; in_band = ''
    stats table('ladder') using (is_row(0) && strcol(FIGURE) eq word(figures, f) \
        ? (hairs = is_rigid(0) ? hairs : with_name(hairs, strcol(HAIR)), strcol(STATUS) eq 'never' \
        ? (in_band = with_name(in_band, strcol(NAME)), 0) : 0) : 0, 0) nooutput
    # Above the scale each method with a name that does not get there has a row of its own.
    band = ''
    do for [m = 1:words(names)] {
        if (place(in_band, word(names, m))) { band = with_name(band, word(names, m)) }
    }
    top = 1.6 * highest
    row_of(name) = top * 10 ** (0.16 * place(band, name))

    panels = words(hairs)
    # The first figure opens the report beside another, on its first screen: it is wide and low, so
    # that its letters can be read there.
    is_first = panels > 1 && word(hairs, 1) eq main_hair
    GAP = is_first ? 18 : 24
    SMALL = panels == 1 ? 560 : is_first ? int((864 - (panels - 1) * GAP) / (0.76 + panels)) : 300
    LARGE = is_first ? int(1.76 * SMALL) : panels == 1 ? 560 : 300
    TALL = is_first ? 250 : 400
    page_width = panels == 1 ? 720 : 110 + LARGE + (SMALL + GAP) * (panels - 1)
    eval figure(word(figures, f), page_width, TALL + 260)
    set multiplot
    eval heading(word(hairs, 1) eq main_hair ? 'What a millimetre costs, from soft to real hair' \
        : 'What a millimetre costs, by the damping of the highest stretch mode', \
        'CPU time of 1 wisp to be within 1 mm rms of the reference solution over all frames')
    do for [p = 1:panels] {
        hair = word(hairs, p)
        eval panel(p == 1 ? 85 : 85 + LARGE + GAP + (SMALL + GAP) * (p - 2), 95, \
                   p == 1 ? LARGE : SMALL, TALL)
        eval powers('x'); eval powers('y')
        set title '{/:Bold '.escaped(hair eq main_hair ? 'the scene''s own hair' : hair).'}' \
            offset 0, -0.6
        with_rigid = has_rigid && hair eq main_hair
        set xrange [0.6 * first:1.7 * (with_rigid ? RIGID : last)]
        set yrange [0.6 * lowest:top * 10 ** (0.16 * (words(band) + 0.6))]
        set xtics autofreq offset 0, 0.3
        if (with_rigid) {
            set xtics 10. ** ceil(log10(first)), 10, last
            set xtics add ('rigid' RIGID)
        }
        set xlabel is_first && !leftmost(p == 1) ? 'EA (N)' : 'stretch stiffness EA (N)' offset 0, 0.4
        set ylabel leftmost(p == 1) ? 'CPU time (s)'.SPREAD : '' offset 0, 0
        if (!leftmost(p == 1)) { set format y '' }
        unset arrow
        if (words(band)) {
            set arrow 1 from graph 0, first top to graph 1, first top nohead lc rgb GREY lw 0.8
        }
        set bars 0
        if (SHOWN) { plot for [m = 1:words(rest)] table('ladder') \
                using (cpu_at(hair, word(rest, m), 'reached')):(column(CPU)) with lines lt REST, \
             for [m = 1:words(names)] '' \
                using (cpu_at(hair, word(names, m), 'reached')):(column(CPU)):(column(LEAST)) \
                :(column(GREATEST)) with yerrorbars lt style_of(word(names, m)) dt solid lw 1 pt 0, \
             for [m = 1:words(names)] '' \
                using (cpu_at(hair, word(names, m), 'reached')):(column(CPU)) \
                with linespoints lt style_of(word(names, m)), \
             for [m = 1:words(names)] '' \
                using (strcol(LIMIT) eq 'failure' ? cpu_at(hair, word(names, m), 'reached') : NaN) \
                :(column(CPU)) with points pt FAILED ps 0.5 lw 1.2 lc rgb '#000000', \
             for [m = 1:words(names)] '' \
                using (cpu_at(hair, word(names, m), 'never')):(row_of(word(names, m))) \
                with points pt FAILED ps 0.8 lw 1.6 lc rgb colour_of(word(names, m)), \
             for [m = 1:with_rigid ? words(rest) : 0] '' \
                using (cpu_of_rigid(word(rest, m), 'reached')):(column(CPU)) \
                with points pt 7 ps 0.4 lc rgb GREY, \
             for [m = 1:with_rigid ? words(names) : 0] '' \
                using (cpu_of_rigid(word(names, m), 'reached')):(column(CPU)) \
                with points lt style_of(word(names, m)), \
             for [m = 1:with_rigid ? words(names) : 0] '' \
                using (cpu_of_rigid(word(names, m), 'never')):(row_of(word(names, m))) \
                with points pt FAILED ps 0.8 lw 1.6 lc rgb colour_of(word(names, m)), \
             for [k = 1:has_tips] '' using (place_here(hair, with_rigid)):(height_here(0)) \
                :(tip_of(told)) @TIP }
        eval heading_done
    }
    eval legend(0, TALL + 155, page_width, 110, panels == 1 ? 6 : is_first ? 4 : 3)
    unreached = words(band) ? '"never reaches it (above)"' : ''
    plot 0 with dots lc bgnd, for [m = 1:words(names)] keyentry with linespoints lt style_of(word(names, m)) \
            title word(names, m), \
         keyentry with points pt FAILED ps 0.5 lw 1.2 lc rgb '#000000' \
            title 'the next longer step fails', \
         keyentry with lines lt REST title rest_title(rest), \
         for [text in unreached] keyentry with points pt FAILED ps 0.8 lw 1.6 lc rgb GREY title text
    unset multiplot
    set output
}
