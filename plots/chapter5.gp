# What a wisp costs in each figure of the thesis's chapter 5, over one that feels no other.
load plots.'/style.gp'
eval require('figures models')

rows_here = 0
stats table('figures') using (rows_here = strcol(1) eq 'figure' ? rows_here : rows_here + 1, 0) nooutput
eval figure('figures', 900, 110 + 34 * rows_here + 70)
set multiplot
eval heading('What a wisp costs in each figure, over one without interaction', \
    'CPU time for a frame and a wisp, median, least to greatest; and the thesis''s')
eval panel(170, 80, 690, 34 * rows_here)
set yrange [-rows_here - 0.4:-0.6]
set logscale x
lowest = 0.5; highest = 8.
stats table('figures') using (lowest = column('ours_least') < lowest ? column('ours_least') : lowest, \
    highest = column('ours_greatest') > highest ? column('ours_greatest') : highest, 0) nooutput
set xrange [0.8 * lowest:1.2 * highest]
set xtics (0.2, 0.5, 1, 2, 5, 10, 20)
set xlabel paper eq '' ? 'times the cost of a wisp of 5.2 without interaction' : 'cost over 5.2 without interaction' offset 0, 0.3
set ytics nomirror
unset ytics
n = 0
name_rows = ''
stats table('figures') using (strcol(1) eq 'figure' ? 0 : (n = n + 1, \
    name_rows = name_rows.sprintf("%s'%s' %d", n > 1 ? ', ' : '', strcol(1), -n), 0), 0) nooutput
eval 'set ytics nomirror out scale 0.6 ('.name_rows.') noenhanced font ",11"'
set arrow 1 from first 1, graph 0 to first 1, graph 1 nohead lt 2
told = told_of('figures', 'figure ours thesis cpu:s evaluations contacts')
m = 0
if (SHOWN) { plot table('figures') using (column('ours')):(-(m = m + 1)):(column('ours_least')):(column('ours_greatest')) \
        with xerrorbars lc rgb '#000000' pt 7 ps 1 lw 1.5, \
     (m = 0, 1 / 0) notitle, \
     '' using (column('thesis')):(-(m = m + 1)) with points pt 6 ps 1.3 lw 2 lc rgb '#D55E00', \
     (m = 0, 1 / 0) notitle, \
     for [n = 1:has_tips] '' using (column('ours')):(-(m = m + 1)):(tip_of(told)) @TIP, \
     (m = 0, 1 / 0) notitle, \
     for [n = 1:has_tips] '' using (column('thesis')):(-(m = m + 1)):(tip_of(told)) @TIP }
eval heading_done
eval legend(0, 110 + 34 * rows_here + 30, 900, 40, 1)
plot @BLANK, keyentry with points pt 7 ps 1 lc rgb '#000000' title 'ours', \
     keyentry with points pt 6 ps 1.3 lw 2 lc rgb '#D55E00' title 'thesis'
unset multiplot
set output
