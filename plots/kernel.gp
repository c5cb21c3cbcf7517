# Evaluations of the kernel between its plain twin and the arithmetic floor; what it executes; and
# the linear solvers in units of an evaluation.
load plots.'/style.gp'
eval require('evaluation operations solvers')

BATCH = 64 # wisps: of the evaluations drawn
TREATMENTS = 'skeleton projection generalised penalty'
BENDINGS = 'none skip hinge'
array bending_title[3] = ['no bending', 'skip springs', 'hinges']

# Rows from top to bottom: the skeleton, then each treatment with 4 and with 8 samples.
slot(treatment, samples) = treatment eq 'skeleton' ? 7 \
    : 7 - 2 * (place(TREATMENTS, treatment) - 2) - samples / 4
set_rows = 'set ytics ("no samples" 7, "projection, 4" 6, "projection, 8" 5, "generalised, 4" 4, ' \
    .'"generalised, 8" 3, "penalty, 4" 2, "penalty, 8" 1); set yrange [0.4:7.6]'
no_rows = 'set ytics ("" 7, "" 6, "" 5, "" 4, "" 3, "" 2, "" 1)'

# --- evaluation ---

CANDIDATES = 6
array who[CANDIDATES] = ['floor of 4 lanes: the machine''s rates', 'kernel, 4 lanes', 'kernel, 1 lane', \
                          'floor of 8 lanes', 'kernel, 8 lanes', 'plain twin']
array column_of[CANDIDATES] = [14, 5, 8, 29, 26, 11]
array its_colour[CANDIDATES] = ['#000000', '#D55E00', '#E69F00', '#777777', '#009E73', '#0072B2']
array its_mark[CANDIDATES] = [2, 7, 6, 1, 9, 5]

eval figure('evaluation', 900, 510)
set multiplot
eval heading('Nanoseconds per free node of one evaluation', \
    sprintf('%d wisps of 12 nodes; medians, quartiles; over the 4 lanes'' mark: how many floors it takes', BATCH))
is(b) = strcol(1) ne 'treatment' && $4 == BATCH && strcol(2) eq word(BENDINGS, b)
do for [b = 1:3] {
    eval panel(130 + 258 * (b - 1), 95, 235, 285)
    set logscale x; set xrange [0.3:200]; set xtics (0.5, 1, 2, 5, 10, 20, 50, 100); set xtics offset 0, 0.3
    set xlabel 'ns per free node' offset 0, 0.4
    eval set_rows
    if (!leftmost(b == 1)) { eval no_rows } else { set ylabel 'treatment, samples' offset 0.5, 0 }
    if (!leftmost(b == 1)) { unset ylabel }
    set label 3 '{/:Bold '.bending_title[b].'}' at graph 0, graph 1 offset character 0, 0.7 left
    set bars 0
    if (SHOWN) { plot table('evaluation') using (is(b) ? $14 : NaN):(slot(strcol(1), $3)):($5 - $14):(0) \
            with vectors nohead lw 1.2 lc rgb '#BBBBBB', \
         for [k = 1:CANDIDATES] '' using (is(b) ? column(column_of[k]) : NaN):(slot(strcol(1), $3)) \
            :(column(column_of[k] + 1)):(column(column_of[k] + 2)) \
            with xerrorbars pt its_mark[k] ps 0.9 lw 1.6 lc rgb its_colour[k], \
         '' using (is(b) ? $5 : NaN):(slot(strcol(1), $3)):(is(b) ? sprintf('%.1f', $23) : '') \
            with labels offset 0, 0.75 font ',11' textcolor rgb '#A84A00', \
         for [n = 1:has_tips] for [k = 1:CANDIDATES] '' using (is(b) ? column(column_of[k]) : NaN) \
            :(slot(strcol(1), $3)):(tip(who[k].sprintf("\n%.3g ns per free node", column(column_of[k])))) @TIP }
    eval heading_done
}
eval legend(0, 435, 900, 65, 2)
plot @BLANK, for [k = 1:CANDIDATES] keyentry with points pt its_mark[k] ps 1.1 lw 1.6 lc rgb its_colour[k] title who[k]
unset multiplot

# --- what is executed ---

KINDS = 7
array kind[KINDS] = ['square roots', 'divisions', 'additions, multiplications', 'comparisons, masks', \
                     'from lane to lane', 'loads, stores, copies', 'addresses, branches']
array kind_colour[KINDS] = ['#000000', '#D55E00', '#0072B2', '#CC79A7', '#E69F00', '#BDBDBD', '#E4E4E4']
ROWS = 4
at_row(treatment) = ROWS + 1 - place(TREATMENTS, treatment)
eval figure('operations', 900, 400)
set multiplot
eval heading('What the 4-lane kernel executes, per free node of 4 wisps', \
    'vector instructions by kind, 4 samples; line: additions, multiplications, divisions and roots that the model needs')
is(b) = strcol(1) ne 'treatment' && strcol(2) eq word(BENDINGS, b) && $3 <= 4
upto(k) = sum [i = 1:k] column(6 + i)
first = 0; most = 10
stats table('operations') using (most = $3 <= 4 && upto(KINDS) > most ? upto(KINDS) : most, 0) nooutput
do for [b = 1:3] {
    eval panel(130 + 258 * (b - 1), 95, 235, 190)
    unset logscale; set xrange [0:1.05 * most]; set yrange [0.4:ROWS + 0.6]; set xtics 0, 200; set mxtics 2; set xtics offset 0, 0.3
    set xlabel 'instructions per node' offset 0, 0.4
    set ytics ('no samples' 4, 'projection' 3, 'generalised' 2, 'penalty' 1)
    if (b > 1) { set ytics ('' 4, '' 3, '' 2, '' 1) }
    unset ylabel
    set label 3 '{/:Bold '.bending_title[b].'}' at graph 0, graph 1 offset character 0, 0.7 left
    if (SHOWN) { plot for [k = 1:KINDS] table('operations') \
            using (is(b) ? 0.5 * (upto(k - 1) + upto(k)) : NaN):(at_row(strcol(1))) \
            :(0.5 * (upto(k) - upto(k - 1))):(0.3) with boxxyerror fill solid noborder fc rgb kind_colour[k], \
         '' using (is(b) ? $4 + $5 + $6 : NaN):(at_row(strcol(1)) - 0.42):(0):(0.84) \
            with vectors nohead lw 2 lc rgb '#009E73' }
    eval heading_done
}
eval legend(0, 335, 900, 60, 2)
plot @BLANK, for [k = 1:KINDS] keyentry with boxes fill solid noborder fc rgb kind_colour[k] title kind[k], \
     keyentry with lines dt solid lw 2 lc rgb '#009E73' title 'needed'
unset multiplot

# --- solvers ---

SOLVERS = 7
label_of(solver, lanes, step) = solver eq 'direct' ? sprintf('direct, %d lane%s', lanes, lanes > 1 ? 's' : '') \
    : solver eq 'cg' ? sprintf('cg, h = %g ms', 1e3 * step) : solver
order = '"direct, 4 lanes" "direct, 1 lane" "klu" "cholmod" "cg, h = 0.1 ms" "cg, h = 1 ms" "cg, h = 10 ms"'
row_of(solver, lanes, step) = SOLVERS + 1 - place(order, label_of(solver, lanes, step))
array stage[3] = ['linearise', 'factor (klu, cholmod: with assembly)', 'solve']
array stage_column[3] = [17, 20, 23]
array stage_colour[3] = ['#009E73', '#D55E00', '#0072B2']
array stage_mark[3] = [13, 7, 5]
array stage_open[3] = [12, 6, 4]
eval figure('solvers', 900, 455)
set multiplot
eval heading('Linear solvers of the implicit step, for one wisp', \
    'in evaluations of a skeleton with 4 lanes; full marks: among 200 wisps, open: alone; h = 1 ms where not said')
do for [s = 1:2] {
    name = s == 1 ? 'skeleton' : 'generalised'
    eval panel(140 + 385 * (s - 1), 95, 350, 255)
    set logscale x; set xrange [1:2500]; set format x '%g'; set xtics (1, 3, 10, 30, 100, 300, 1000); set xtics offset 0, 0.3
    set xlabel 'skeleton evaluations' offset 0, 0.4
    set yrange [0.4:SOLVERS + 0.6]
    set ytics ('' 1) # gnuplot wants one before others are added
    do for [i = 1:SOLVERS] { set ytics add (s == 1 ? word(order, i) : '' SOLVERS + 1 - i) }
    set label 3 '{/:Bold '.(s == 1 ? 'no samples (30 unknowns)' : 'generalised, 4 samples (70 unknowns)').'}' \
        at graph 0, graph 1 offset character 0, 0.7 left
    set arrow 1 from first 3, graph 0 to first 3, graph 1 nohead lt 2
    is(w) = strcol(1) eq name && $3 == w
    shown(k, solver) = !(k == 2 && solver eq 'cg') # nothing to factor
    if (SHOWN) { plot for [k = 1:3] table('solvers') using (is(200) && shown(k, strcol(4)) ? column(stage_column[k]) : NaN) \
            :(row_of(strcol(4), $5, $6)) with points pt stage_mark[k] ps 1 lw 1.5 lc rgb stage_colour[k], \
         for [k = 1:3] '' using (is(1) && shown(k, strcol(4)) ? column(stage_column[k]) : NaN) \
            :(row_of(strcol(4), $5, $6)) with points pt stage_open[k] ps 1 lw 1.5 lc rgb stage_colour[k], \
         for [n = 1:has_tips] for [k = 1:3] '' using ((is(1) || is(200)) && shown(k, strcol(4)) \
            ? column(stage_column[k]) : NaN):(row_of(strcol(4), $5, $6)) \
            :(tip(label_of(strcol(4), $5, $6).sprintf("\n%s\n%g wisp%s\n%.3g evaluations of a skeleton", \
                stage[k], $3, $3 > 1 ? 's' : '', column(stage_column[k])))) @TIP }
    eval heading_done
}
eval legend(0, 410, 900, 40, 1)
plot @BLANK, for [k = 1:3] keyentry with points pt stage_mark[k] ps 1.1 lw 1.5 lc rgb stage_colour[k] title stage[k], \
     keyentry with lines lt 2 title 'goal for factor + solve, 4 lanes, 200 wisps'
unset multiplot
set output
