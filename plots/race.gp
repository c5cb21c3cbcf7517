# Error against cost on scenes of wisps: one figure for each scene, one panel for each treatment and
# measure of cost. WHAT is its title.
load plots.'/style.gp'
eval require('scenes')

larger(a, b) = a > b ? a : b

# Trajectories of other programs have no stepper, a colour that no method has, and a mark each.
FOREIGN = '#D100D1'
foreign = ''
is_foreign(x) = strcol(3) eq '-'
do for [v = 1:OTHERS] { eval styled(-2, v, FOREIGN, other_mark[v]) }
foreign_mark(name) = (place(foreign, name) - 1) % OTHERS + 1
look_of(name) = place(foreign, name) ? 80 + foreign_mark(name) : style_of(name)
# What it cost a trajectory need not say.
silence(cpu, calls) = cpu == cpu && calls == calls ? '' : ': '.(cpu == cpu ? 'evaluations' \
    : calls == calls ? 'CPU time' : 'cost').' not given (line)'

# columns of a scene's table
STATUS = 5; ERROR = 7; CPU = 14; LEAST = 15; GREATEST = 16; CALLS = 17; LIMITED = 19
ERROR_LEAST = 22; ERROR_GREATEST = 23; RUNS = 24
# and of that of its references
BOUND = 2; TREATMENT_ERROR = 6; COMPARED = 8; DURATION = 9

is_failed(status) = status ne 'finished' && status ne 'refused' && status ne 'left out' \
    && status ne 'status'
is_point(m) = strcol(1) eq word(names, m) && strcol(2) eq treatment
is_good(m) = is_point(m) && strcol(STATUS) eq 'finished'
# What is said of a method's failures: how many, and of the first one of what kind and when.
kinds = ''
is_shown(x) = strcol(2) eq treatment && (strcol(STATUS) eq 'finished' || is_failed(strcol(STATUS)))
height_here(x) = strcol(STATUS) eq 'finished' ? larger(column(ERROR), bottom) \
    : place(in_band, strcol(1)) ? row_of(strcol(1)) : NaN
say(status, t) = status.(t == t ? sprintf(', %.2g s', t) : '')
count_failure(m) = (failures = failures + 1, kinds = kinds eq '' ? say(strcol(STATUS), $6) : kinds, 0)
at(x) = x > 0 ? x : 0.6 * first # a run that was killed could not say what it had done
row_of(name) = TOP * 10 ** (0.6 * place(in_band, name))

scene_files = ''; scene_names = ''
array samples_of[64]; array length_of[64]; array wisps_of[64]
stats table('scenes') using (strcol(1) eq 'file' ? 0 \
    : (scene_files = scene_files.quoted(strcol(1)), scene_names = scene_names.quoted(strcol(2)), \
       samples_of[words(scene_files)] = $3, length_of[words(scene_files)] = $4, \
       wisps_of[words(scene_files)] = $5), 0) nooutput

do for [s = 1:words(scene_files)] {
    scene = word(scene_files, s)
    treatments = samples_of[s] > 0 ? 'projection penalty generalised' : 'generalised'
    there = ''; compared = 1e300; duration = 0
    stats table(scene.'-reference') using (strcol(1) eq 'treatment' ? 0 \
        : (there = with_name(there, strcol(1)), compared = column(COMPARED) < compared \
           ? column(COMPARED) : compared, duration = column(DURATION)), 0) nooutput
    chosen = ''
    do for [t in treatments] { if (place(there, t)) { chosen = chosen.' '.t } }
    treatments = chosen; columns = words(treatments) > 1 ? words(treatments) : 2
    TOP = length_of[s] # m: an error of the longest wisp's length is as bad as none
    many = words(treatments) > 1
    page_width = columns == 3 ? 1300 : 1000
    pitch = (page_width - 85) / columns # from panel to panel
    eval names_of(scene)
    told = told_of(scene, 'method treatment setting status failure_time:s error:m cpu_median:s force_evaluations')
    # other programs, the thesis's method, then those on the front of CPU time, then methods as they
    # are, the cheapest first, then variants
    foreign = ''
    stats table(scene) using (is_foreign(0) ? (foreign = with_name(foreign, strcol(1)), 0) : 0) nooutput
    chosen = ''
    do for [m = 1:words(foreign)] { chosen = named(chosen, word(foreign, m)) }
    if (place(names, 'euler')) { chosen = named(chosen, 'euler') }
    stats table(scene.'-front') using (strcol(2) eq 'cpu' \
        ? (chosen = named(chosen, strcol(5)), 0) : 0) nooutput
    # CPU time within a millimetre, of methods as they are.
    array cost[words(names)]
    do for [m = 1:words(names)] {
        cost[m] = 1e300
        stats table(scene) using (strcol(1) eq word(names, m) && strcol(STATUS) eq 'finished' \
            && column(ERROR) < 1e-3 && column(CPU) < cost[m] ? (cost[m] = column(CPU), 0) : 0, 0) nooutput
    }
    is_cheaper(m, k) = cost[k] < cost[m] || (cost[k] == cost[m] && k < m)
    rank_of(m) = sum [k = 1:words(names)] (words(word(names, k)) == 1 && is_cheaper(m, k))
    do for [r = 0:words(names) - 1] {
        do for [m = 1:words(names)] {
            if (words(word(names, m)) == 1 && rank_of(m) == r) { chosen = named(chosen, word(names, m)) }
        }
    }
    stats table(scene.'-front') using (strcol(2) eq 'evaluations' \
        ? (chosen = named(chosen, strcol(5)), 0) : 0) nooutput
    do for [m = 1:words(names)] { chosen = named(chosen, word(names, m)) }
    finished = ''
    stats table(scene) using (strcol(STATUS) eq 'finished' \
        ? (finished = with_name(finished, strcol(1)), 0) : 0) nooutput
    eval part_names
    drawn = ''
    do for [m = 1:words(rest)] { if (place(finished, word(rest, m))) { drawn = drawn.quoted(word(rest, m)) } }
    rest = drawn
    # The legend's columns are as wide as a name with its slopes; six entries are not of methods.
    legend_columns = page_width == 1300 || !many ? 3 : 2
    legend_height = 40 + 18 * ((words(names) + 6 + legend_columns - 1) / legend_columns)
    page_height = (many ? 925 : 555) + legend_height
    eval figure(scene, page_width, page_height)
    # Above the scale every method that fails somewhere has a row of its own.
    in_band = ''; lowest = TOP
    stats table(scene) using (in_band = is_failed(strcol(STATUS)) && place(names, strcol(1)) \
        ? with_name(in_band, strcol(1)) : in_band, 0) nooutput
    stats table(scene) using (lowest = strcol(STATUS) eq 'finished' && column(ERROR) > 0 \
        && column(ERROR) < lowest ? column(ERROR) : lowest, 0) nooutput
    highest = TOP * 10 ** (0.6 * (words(in_band) + 0.8))
    bottom = larger(1e-15, lowest / 10)
    # Each method with its slopes, one for each treatment.
    titles = ''
    do for [m = 1:words(names)] {
        slopes = ''; some = 0
        do for [t in treatments] {
            one = '–'
            stats table(scene.'-slopes') using (strcol(1) eq word(names, m) && strcol(2) eq t \
                ? (some = 1, one = slope_text(strcol(3), $4, $5), 0) : 0, 0) nooutput
            slopes = slopes.(slopes eq '' ? ': ' : ', ').one
        }
        silent = ''
        stats table(scene) using (is_foreign(0) && strcol(1) eq word(names, m) \
            ? (silent = silence(column(CPU), column(CALLS)), 0) : 0, 0) nooutput
        titles = titles.quoted(word(names, m).(some ? slopes : silent))
    }
    is_named(x) = place(names, strcol(1)) && strcol(STATUS) eq 'finished'
    jittered = ''; has_limited = 0
    # A band that is no higher than a mark is hidden by it, and that of the reference, whose curve is
    # steep, by its line.
    is_wide(x) = strcol(1) ne 'reference' && column(RUNS) > 1 \
        && column(ERROR_GREATEST) > 3 * larger(column(ERROR_LEAST), bottom)
    stats table(scene) using (is_named(0) ? (jittered = jittered eq '' && is_wide(0) ? strcol(1) : jittered, \
        has_limited = column(LIMITED) == 1 ? 1 : has_limited, 0) : 0, 0) nooutput
    has_bound = 0; has_inexact = 0 # drawn somewhere: then in the legend, where no data are under it
    set multiplot
    eval heading(WHAT.': '.escaped(word(scene_names, s)) \
        .(!many && samples_of[s] > 0 ? ' with '.word(treatments, 1) : ''), \
        'rms distance of the free nodes from the reference solution'.(columns == 3 ? ' of the same treatment' : '') \
        .', all frames'.(compared < duration ? sprintf(' to %.2g s', compared) : '') \
        .'; bars: least to greatest; ×: failed; legend: slopes'.(many ? ', panel by panel' : ''))
    do for [p = 0:(many ? 2 * columns - 1 : 1)] {
        row = many ? p / columns : 0
        place_x = many ? p % columns : p
        measure = many ? row : p
        treatment = word(treatments, many ? place_x + 1 : 1)
        c = measure == 0 ? CPU : CALLS
        # one range of cost for all treatments
        first = 1e300; last = 0
        unset logscale; set autoscale
        stats table(scene) using (x = column(c), ok = strcol(STATUS) eq 'finished' \
            || is_failed(strcol(STATUS)), first = ok && x > 0 && x < first ? x : first, \
            last = ok && x > last ? x : last, 0) nooutput
        if (last == 0) { first = 1; last = 10 }
        bound = NaN; inexact = NaN
        stats table(scene.'-reference') using (strcol(1) eq treatment \
            ? (bound = column(BOUND), inexact = column(TREATMENT_ERROR)) : 0, 0) nooutput
        do for [i = 1:20] { unset label 20 + i }
        do for [i = 1:measure == 0 ? words(in_band) : 0] {
            failures = 0; kinds = ''
            stats table(scene) using (strcol(1) eq word(in_band, i) && strcol(2) eq treatment \
                && is_failed(strcol(STATUS)) ? count_failure(0) : 0, 0) nooutput
            if (failures && (paper eq '' || (!many && !in_column))) { # elsewhere it has no room
                remark = word(in_band, i).', '.(failures == 1 ? kinds : sprintf('%d: %s', failures, kinds))
                set label 20 + i remark \
                    at graph 0.99, first row_of(word(in_band, i)) right font ',11' \
                    textcolor rgb ink_of(word(in_band, i))
            }
        }
        if (many) {
            eval panel(80 + pitch * place_x, 95 + 415 * row, pitch - 30, 345)
            if (row == 0 || paper ne '') { set title '{/:Bold '.treatment.'}' offset 0, -0.6 } else { unset title }
        } else { eval panel(80 + pitch * p, 70, pitch - 30, 420); unset title }
        eval powers('x'); eval powers('y')
        set ytics 1e-16, 100, 1; set mytics 1
        if (!leftmost(place_x == 0)) { set format y '' }
        set xrange [0.5 * first:2 * last]; set yrange [bottom:highest]
        set xtics offset 0, 0.3
        wisps = wisps_of[s] == 1 ? '1 wisp' : sprintf('%d wisps', wisps_of[s])
        set xlabel (measure == 0 ? 'CPU time of '.wisps.(paper eq '' ? ' on one thread' : '').' (s)' \
            : 'force evaluations of '.wisps) offset 0, 0.4
        set ylabel leftmost(place_x == 0) ? 'integration error (m)' : '' offset 1, 0
        unset arrow; unset label 3; unset label 4
        set arrow 1 from graph 0, first TOP to graph 1, first TOP nohead lc rgb GREY lw 0.8
        if (bound == bound && bound > bottom) {
            set arrow 2 from graph 0, first bound to graph 1, first bound nohead lt 2 lw 1.2
            has_bound = 1
        }
        unpriced = ''; heights = ''
        stats table(scene) using (is_foreign(0) && strcol(2) eq treatment && column(c) != column(c) \
            ? (unpriced = unpriced.quoted(strcol(1)), heights = heights.sprintf(' %.9g', \
               larger(column(ERROR), bottom)), 0) : 0, 0) nooutput
        do for [i = 1:20] { unset label 50 + i }
        do for [i = 1:(words(unpriced) < 20 ? words(unpriced) : 20)] {
            y = real(word(heights, i)); look = look_of(word(unpriced, i))
            set arrow 50 + i from graph 0, first y to graph 1, first y nohead lt look
            set label 50 + i '' at graph 0.97, first y point lt look
        }
        if (inexact == inexact && inexact > bottom) {
            set arrow 3 from graph 0, first inexact to graph 1, first inexact nohead \
                lc rgb GREY dt (8,4) lw 1.2
            has_inexact = 1
        }
        if (!(bound == bound) && place_x == 0) {
            set label 4 'the reference has no bound' at graph 0.01, graph 0.03 left font ',11' \
                textcolor rgb GREY
        }
        set bars 0
        if (SHOWN) { plot table(scene.'-front') using (strcol(1) eq treatment \
                && strcol(2) eq (measure == 0 ? 'cpu' : 'evaluations') ? $3 : NaN):4 \
                with steps lw 7 lc rgb '#D9D9D9' dt solid, \
             for [m = 1:words(rest)] table(scene) \
                using (strcol(1) eq word(rest, m) && strcol(2) eq treatment \
                    && strcol(STATUS) eq 'finished' ? column(c) : NaN) \
                :(larger(column(ERROR), bottom)) with lines lt REST, \
             for [m = 1:words(names)] table(scene) \
                using (is_good(m) && column(RUNS) > 1 ? column(c) : NaN) \
                :(larger(column(ERROR_LEAST), bottom)):(larger(column(ERROR_GREATEST), bottom)) \
                with filledcurves fs transparent solid 0.25 noborder \
                lc rgb colour_of(word(names, m)), \
             for [m = 1:words(names)] table(scene) \
                using (is_good(m) ? column(c) : NaN):(larger(column(ERROR), bottom)) \
                :(measure ? column(c) : column(LEAST)):(measure ? column(c) : column(GREATEST)) \
                with xerrorbars lt look_of(word(names, m)) dt solid lw 1 pt 0, \
             for [m = 1:words(names)] '' \
                using (is_good(m) ? column(c) : NaN):(larger(column(ERROR), bottom)) \
                with linespoints lt look_of(word(names, m)), \
             for [m = 1:words(names)] '' \
                using (is_good(m) && column(LIMITED) == 1 ? column(c) : NaN) \
                :(larger(column(ERROR), bottom)) \
                with points lt look_of(word(names, m)) lc rgb '#BBBBBB', \
             for [m = 1:words(names)] '' \
                using (is_point(m) && is_failed(strcol(STATUS)) ? at(column(c)) : NaN) \
                :(row_of(strcol(1))) \
                with points pt FAILED ps 0.8 lw 1.6 lc rgb colour_of(word(names, m)), \
             for [k = 1:has_tips] '' using (is_shown(0) ? at(column(c)) : NaN) \
                :(height_here(0)):(tip_of(told)) @TIP }
        eval heading_done
    }
    eval legend(0, page_height - legend_height, page_width, legend_height, \
        (words(names) + 6 + legend_columns - 1) / legend_columns)
    plot @BLANK, for [m = 1:words(names)] keyentry with linespoints lt look_of(word(names, m)) \
            title word(titles, m), \
         keyentry with boxes fs solid 0.25 noborder lc rgb colour_of(jittered) \
            title jittered eq '' ? '' : 'jittered tolerances', \
         keyentry with lines lw 7 lc rgb '#D9D9D9' dt solid title 'Pareto front', \
         keyentry with points pt 7 ps 0.85 lc rgb '#BBBBBB' title has_limited ? 'within ten times the bound' : '', \
         keyentry with lines lt REST title rest_title(rest), \
         keyentry with lines lt 2 lw 1.2 title has_bound ? 'bound of the reference' : '', \
         keyentry with lines lt 1 dt (8,4) lw 1.2 \
            title has_inexact ? 'error of the treatment' : ''
    unset multiplot
}
set output
