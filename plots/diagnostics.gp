# Where a run's energy is and went, and extremes of its state: a figure for each diagnostics*.tsv.
load plots.'/style.gp'

# --- the tables ---

files = system("cd '".shell(data)."' && ls | grep '^diagnostics.*[.]tsv$'")
if (files eq '') { exit error data.'/diagnostics.tsv: no such table; run with --diagnostics first' }
stem(file) = file[1:strlen(file) - 4]
# In an experiment's folder: diagnostics-VARIANT.tsv.
variant(file) = strlen(stem(file)) > 12 ? ', '.stem(file)[13:] : ''
# What a line of provenance says, by a pattern of sed.
says(file, pattern) = system("sed -n 's/^# ".pattern."/\\1/p' '".shell(data.'/'.file)."'")
setting(file, name) = says(file, 'settings.*"'.name.'":"*\([^",}]*\).*')
settings(file) = setting(file, 'stepper').', '.setting(file, 'treatment').', ' \
    .(setting(file, 'step') ne '' ? 'steps of '.setting(file, 'step').' s' \
                                  : 'relative tolerance '.setting(file, 'rtol'))

# --- what is drawn ---

# The energies of a table: its columns between the time and the first work.
energies_of(file) = system("sed -n '/^#/d; s/^t\t//; s/\twork_.*//; s/\t/ /g; p; q' '" \
    .shell(data.'/'.file)."'")
WORKS = 'work_drag work_stretch_damping work_bending_damping work_envelope_damping work_treatment' \
    .' work_style work_head jump_wisp_contact jump_body_contact jump_clamp jump_other residual' \
    .' work_body_damping work_bodies'
title_of(name) = name eq 'gravity' ? 'gravity, from its start' : name eq 'stretch' ? 'stretch springs' \
    : name eq 'bending' ? 'bending' : name eq 'envelope' ? 'envelope' \
    : name eq 'work_drag' ? 'air' : name eq 'work_stretch_damping' ? 'stretch damping' \
    : name eq 'work_bending_damping' ? 'bending damping' \
    : name eq 'work_envelope_damping' ? 'envelope damping' : name eq 'work_treatment' ? 'treatment' \
    : name eq 'work_body_damping' ? 'damping in bodies' : name eq 'work_bodies' ? 'motion of bodies' \
    : name eq 'work_style' ? 'style' : name eq 'work_head' ? 'head' \
    : name eq 'jump_wisp_contact' ? 'contact of wisps' : name eq 'jump_body_contact' ? 'bodies' \
    : name eq 'jump_clamp' ? 'clamp' : name eq 'jump_other' ? 'other events' \
    : name eq 'residual' ? 'in none of these: error' : name
set linetype 11 lc rgb '#D55E00' dt solid pt 7 lw 1.9           # kinetic; air
set linetype 12 lc rgb '#0072B2' dt (12,4) pt 5 lw 1.9          # gravity; stretch damping
set linetype 13 lc rgb '#009E73' dt (10,3,2,3) pt 9 lw 1.9      # stretch; bending damping
set linetype 14 lc rgb '#CC79A7' dt (5,3) pt 11 lw 1.9          # bending; envelope damping
set linetype 15 lc rgb '#8A5F00' dt (2.5,2.5) pt 13 lw 1.9      # envelope; treatment
set linetype 16 lc rgb '#56B4E9' dt (14,3,2,3,2,3) pt 15 lw 1.9 # in bodies; style
set linetype 17 lc rgb '#8C8C00' dt (8,4) pt 7 lw 1.9           # head
set linetype 18 lc rgb '#E69F00' dt solid pt 5 lw 1.9           # contact of wisps
set linetype 19 lc rgb '#A84A00' dt (6,2) pt 9 lw 1.9           # bodies
set linetype 20 lc rgb '#7F7F7F' dt (12,4) pt 11 lw 1.9         # clamp
set linetype 21 lc rgb '#7F7F7F' dt (2,2) pt 13 lw 1.9          # other events
set linetype 22 lc rgb '#000000' dt solid lw 1.2 pt 2           # residual
set linetype 23 lc rgb '#A84A00' dt (10,3,2,3) pt 7 lw 1.9      # damping in bodies
set linetype 24 lc rgb '#A84A00' dt (2.5,2.5) pt 13 lw 1.9      # motion of bodies
style(list, name) = 10 + place(list, name)
open_of(pt) = pt == 2 ? 2 : pt - 1

size(x) = x == x ? abs(x) : 0
most_of(table, name) = 'most = 0; stats table using (most = size(column("'.name.'")) > most ? ' \
    .'size(column("'.name.'")) : most, 0) nooutput'
# A unit in which the largest number is between 1 and 1000.
scale_of(x) = x >= 1 ? 1. : x >= 1e-3 ? 1e3 : x >= 1e-6 ? 1e6 : 1e9
unit_of(scale, unit) = (scale == 1 ? '' : scale == 1e3 ? 'm' : scale == 1e6 ? 'µ' : 'n').unit
# Tics for a low panel from 0 to somewhat above x: steps of 0.5, 1 or 2.
decade(x) = 10**floor(log10(x))
step_for(x) = (x / decade(x) < 2 ? 0.5 : x / decade(x) < 4 ? 1 : 2) * decade(x)
few_tics(x) = sprintf('set ytics 0, %g; set yrange [0:%g]', step_for(x > 0 ? x : 1), x > 0 ? 1.12 * x : 1)

# Where frames are finer than ticks, most have no contacts: they are added up over 1/30 s.
bin(t) = fine ? ceil(30 * t - 1e-6) / 30. : t
most_together(table, name) = 'most = 0; sum = 0; last = -1; stats table using (' \
    .'sum = (bin(column("t")) == last ? sum : 0) + column("'.name.'"), last = bin(column("t")), ' \
    .'most = sum > most ? sum : most) nooutput'

do for [f = 1:words(files)] {
    table = data.'/'.word(files, f)
    ENERGIES = energies_of(word(files, f))
    set datafile separator "\t"; set datafile columnheaders
    unset logscale; set autoscale

    # --- which numbers there are, and how large ---
    shown = ''; energy = 0; works = 0; least = 1e300; end = 0; frames = 0; start = 0; from = 0
    stats table using (start = $0 == 0 ? column("gravity") : start, \
        from = $0 == 0 ? sum [i = 1:words(ENERGIES)] column(word(ENERGIES, i)) : from, \
        end = column("t"), frames = frames + 1, 0) nooutput
    if (!(end > 0)) { end = 1. / 30 } # of a run that failed at once there is only its start
    stored = ''; rounding = 0
    do for [name in ENERGIES] {
        eval most_of(table, name)
        rounding = 1e-14 * most > rounding ? 1e-14 * most : rounding
        if (name eq 'gravity') {
            most = 0
            stats table using (most = size(column("gravity") - start) > most \
                ? size(column("gravity") - start) : most, 0) nooutput
        }
        if (most > 0) { stored = stored.' '.name }
        energy = most > energy ? most : energy
    }
    do for [name in WORKS] {
        eval most_of(table, name)
        if (most > (name eq 'jump_other' ? rounding : 0)) {
            shown = shown.' '.name
            works = most > works ? most : works
            least = most < least ? most : least
        }
    }
    scale = scale_of(energy)
    every_few = frames > 24 ? int(frames / 12) : 2
    array extreme[6]
    do for [k = 1:6] {
        eval most_of(table, word('strain largest_radius body_contacts wisp_contacts penetration speed', k))
        extreme[k] = most
    }

    touched = extreme[3] + extreme[4] + extreme[5] > 0
    fine = frames > 31 * end + 1
    eval figure(stem(word(files, f)), 900, touched ? 1030 : 865)
    set datafile columnheaders
    set multiplot
    scene = says(word(files, f), 'scene \(.*\), hash.*')
    eval heading('Energy of '.escaped(scene) \
        .(variant(word(files, f)) eq ', '.scene ? '' : escaped(variant(word(files, f)))), \
        escaped(settings(word(files, f))))

    # --- where the energy is ---
    eval panel(85, 95, 560, 250)
    set xrange [0:end]; set xtics offset 0, 0.3; set format x ''
    if (lowest(0)) { set xlabel 'time (s)' offset 0, 0.5; set format x '%g' }
    set ylabel 'energy ('.unit_of(scale, 'J').')' offset -0.8, 0
    set label 3 '{/:Bold where it is}' at graph 0, graph 1 offset character 0, 0.7 left
    set xzeroaxis lt 1 lw 0.8
    if (SHOWN) { plot for [name in stored] table using (column("t")) \
            :(scale * (column(name) - (name eq 'gravity' ? start : 0))) \
            with linespoints lt style(ENERGIES, name) ps 0.8 pointinterval every_few, \
         table using (column("t")):(scale * ((sum [i = 1:words(ENERGIES)] column(word(ENERGIES, i))) - from)) \
            with lines lt 1 lw 3 lc rgb '#BBBBBB' }
    eval heading_done

    # --- what changed it ---
    eval panel(85, 400, 560, 250)
    unset xzeroaxis
    eval powers('y')
    set yrange [least / 20:3 * works]
    set format x '%g'
    set xlabel 'time (s)' offset 0, 0.5
    set ylabel '|sum since the start| (J)' offset -0.8, 0
    set label 3 '{/:Bold what changed it}: filled marks take, open marks add'
    if (SHOWN) { plot for [name in shown] table using (column("t")):(size(column(name)) > 0 ? size(column(name)) : NaN) \
            with lines lt style(WORKS, name), \
         for [i = 1:words(shown)] table \
            using (int($0) % every_few == i % every_few && column(word(shown, i)) < 0 ? column("t") : NaN) \
            :(size(column(word(shown, i)))) with points lt style(WORKS, word(shown, i)) ps 0.8, \
         for [i = 1:words(shown)] table \
            using (int($0) % every_few == i % every_few && column(word(shown, i)) > 0 ? column("t") : NaN) \
            :(size(column(word(shown, i)))) with points lt style(WORKS, word(shown, i)) ps 0.8 \
            pt open_of(int(word('7 5 9 11 13 15 7 5 9 11 13 2 7 13', place(WORKS, word(shown, i))))) }
    unset logscale; set autoscale y; set format y '%g'; set mytics 1

    # --- extremes; contacts only where there are any ---
    do for [k = 1:(!touched ? 2 : extreme[2] == 0 && extreme[5] == 0 ? 3 : 4)] {
        eval panel(85 + (k - 1) % 2 * 425, k <= 2 ? 715 : 880, 350, 95)
        set xrange [0:end]
        if (k > 2 || !touched) { set xlabel 'time (s)' offset 0, 0.5; set format x '%g' } \
        else { unset xlabel; set format x '' }
        if (k == 1) {
            set label 3 '{/:Bold strain}, the largest of a segment'
            eval few_tics(100 * extreme[1])
            set ylabel 'per cent' offset -0.8, 0
            if (SHOWN) { plot table using (column("t")):(100 * column("strain")) with lines lt 11 }
        }
        if (k == 2 && extreme[2] > 0) {
            set label 3 '{/:Bold samples}: the furthest, and the nearest (dashed)'
            eval few_tics(extreme[2])
            set ylabel 'r/R' offset -0.8, 0
            if (SHOWN) { plot table using (column("t")):(column("largest_radius")) with lines lt 11, \
                 table using (column("t")):(column("least_radius")) with lines lt 12 }
        }
        if (k == 2 && extreme[2] == 0 || k == 4 && extreme[5] == 0) {
            set label 3 '{/:Bold speed}, the largest'
            eval few_tics(extreme[6])
            set ylabel 'm/s' offset -0.8, 0
            if (SHOWN) { plot table using (column("t")):(column("speed")) with lines lt 11 }
        }
        if (k == 3) {
            set label 3 '{/:Bold contacts} '.(fine ? 'in 1/30 s' : 'from frame to frame') \
                .(extreme[3] == 0 ? ', of wisps' : extreme[4] == 0 ? ', with bodies' : ', of wisps dashed')
            eval most_together(table, 'body_contacts'); together = most
            eval most_together(table, 'wisp_contacts')
            eval few_tics(most > together ? most : together)
            set ylabel 'number' offset -0.8, 0
            if (SHOWN) { plot table using (bin(column("t"))):(extreme[3] > 0 ? column("body_contacts") : -1) \
                    smooth frequency with lines lt 11, \
                 table using (bin(column("t"))):(extreme[4] > 0 ? column("wisp_contacts") : -1) \
                    smooth frequency with lines lt 12 }
        }
        if (k == 4 && extreme[5] > 0) {
            deep = scale_of(extreme[5])
            set label 3 '{/:Bold depth} of the deepest node in a body'
            eval few_tics(deep * extreme[5])
            set ylabel unit_of(deep, 'm') offset -0.8, 0
            if (SHOWN) { plot table using (column("t")):(deep * column("penetration")) with lines lt 11 }
        }
    }
    unset label 3

    # --- legends ---
    eval legend(655, 95, 240, 250, words(stored) + 1)
    set key vertical
    plot @BLANK, for [name in stored] keyentry with linespoints lt style(ENERGIES, name) ps 0.9 \
            title title_of(name), \
         keyentry with lines lt 1 lw 3 lc rgb '#BBBBBB' title 'all, from its start'
    eval legend(655, 400, 240, 250, words(shown))
    set key vertical
    plot @BLANK, for [name in shown] keyentry with linespoints lt style(WORKS, name) ps 0.9 \
            title title_of(name)
    unset multiplot
    unset datafile columnheaders
}
set output
