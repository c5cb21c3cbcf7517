# What a millimetre costs each method along stretch stiffness, one panel for each damping.
load plots.'/style.gp'
eval require('ladder crossings')

# columns of the table
EA = 1; ZETA = 2; NAME = 3; CPU = 8; LEAST = 9; GREATEST = 10; STATUS = 13; LIMIT = 14

zetas = ''; names = ''
first = 1e300; last = 0; lowest = 1e300; highest = 0
is_row(x) = strcol(STATUS) eq 'reached' || strcol(STATUS) eq 'never'
in_all(x) = strcol(STATUS) eq 'reached' ? (lowest = column(LEAST) < lowest ? column(LEAST) : lowest, \
    highest = column(GREATEST) > highest ? column(GREATEST) : highest, 0) : 0
take(x) = (zetas = with_name(zetas, strcol(ZETA)), names = with_name(names, strcol(NAME)), \
    first = column(EA) < first ? column(EA) : first, last = column(EA) > last ? column(EA) : last, \
    in_all(0))
stats table('ladder') using (is_row(0) ? take(0) : 0, 0) nooutput
if (last == 0) { exit error 'ladder: no method has a row' }
if (highest == 0) { lowest = 1e-3; highest = 1 }

# What the thesis took has a name, and the cheapest where the hair is stiffest.
array cost[words(names)]
do for [m = 1:words(names)] {
    cost[m] = word(names, m) eq 'euler' ? 0 : 1e300
    stats table('ladder') using (strcol(NAME) eq word(names, m) && strcol(STATUS) eq 'reached' \
        && column(EA) == last && column(CPU) < cost[m] ? (cost[m] = column(CPU), 0) : 0) nooutput
}
before(m) = sum [k = 1:words(names)] (cost[k] < cost[m] || (cost[k] == cost[m] && k < m))
chosen = ''
do for [m = 1:words(names)] { if (before(m) < NAMED) { chosen = named(chosen, word(names, m)) } }
eval part_names

# Above the scale each method that never gets there has a row of its own.
in_band = ''
stats table('ladder') using (in_band = strcol(STATUS) eq 'never' ? with_name(in_band, strcol(NAME)) \
    : in_band, 0) nooutput
top = 1.6 * highest
row_of(name) = top * 10 ** (0.16 * place(in_band, name))

panels = words(zetas)
PANEL = panels == 1 ? 560 : 350
page_width = panels == 1 ? 720 : 95 + (PANEL + 25) * panels
eval figure('ladder', page_width, 700)
set multiplot
eval heading('What a millimetre costs', \
    '1 mm rms from the tight solution, over all frames; ζ: damping of the highest stretch mode')
do for [p = 1:panels] {
    zeta = word(zetas, p)
    eval panel(95 + (PANEL + 25) * (p - 1), 95, PANEL, 400)
    eval powers('x'); eval powers('y')
    set title '{/:Bold ζ = '.zeta.'}' offset 0, -0.6
    set xrange [0.6 * first:1.7 * last]
    set yrange [0.6 * lowest:top * 10 ** (0.16 * (words(in_band) + 0.6))]
    set xtics offset 0, 0.3
    set xlabel 'stretch stiffness EA (N)' offset 0, 0.4
    set ylabel p == 1 ? 'CPU time of 1 wisp (s): median, least to greatest' : '' offset 0, 0
    if (p > 1) { set format y '' }
    unset arrow
    if (words(in_band)) {
        set arrow 1 from graph 0, first top to graph 1, first top nohead lc rgb GREY lw 0.8
    }
    set bars 0
    is_here(m) = strcol(ZETA) eq zeta && strcol(NAME) eq word(names, m)
    is_good(m) = is_here(m) && strcol(STATUS) eq 'reached'
    is_other(m) = strcol(ZETA) eq zeta && strcol(NAME) eq word(rest, m) && strcol(STATUS) eq 'reached'
    plot for [m = 1:words(rest)] table('ladder') \
            using (is_other(m) ? column(EA) : NaN):(column(CPU)) with lines lt REST, \
         for [m = 1:words(names)] table('ladder') \
            using (is_good(m) ? column(EA) : NaN):(column(CPU)):(column(LEAST)):(column(GREATEST)) \
            with yerrorbars lt style_of(word(names, m)) dt solid lw 1 pt 0, \
         for [m = 1:words(names)] '' \
            using (is_good(m) ? column(EA) : NaN):(column(CPU)) \
            with linespoints lt style_of(word(names, m)), \
         for [m = 1:words(names)] '' \
            using (is_good(m) && strcol(LIMIT) eq 'failure' ? column(EA) : NaN):(column(CPU)) \
            with points pt FAILED ps 0.5 lw 1.2 lc rgb '#000000', \
         for [m = 1:words(names)] '' \
            using (is_here(m) && strcol(STATUS) eq 'never' ? column(EA) : NaN):(row_of(word(names, m))) \
            with points pt FAILED ps 0.8 lw 1.6 lc rgb colour_of(word(names, m))
    eval heading_done
}
eval legend(0, 560, page_width, 130, panels == 1 ? 6 : 4)
unreached = words(in_band) ? '"never reaches it (above the line)"' : ''
plot @BLANK, for [m = 1:words(names)] keyentry with linespoints lt style_of(word(names, m)) \
        title word(names, m), \
     keyentry with points pt FAILED ps 0.5 lw 1.2 lc rgb '#000000' \
        title 'fails at the next longer step', \
     keyentry with lines lt REST title rest_title(rest), \
     for [text in unreached] keyentry with points pt FAILED ps 0.8 lw 1.6 lc rgb GREY title text
unset multiplot
set output
