# The one style of every figure. Each script loads it first; wisplab sets `plots` (this folder),
# `data` (the experiment's tables), `out` and `format` (svg or png), and the configurations' styles.
#
#   eval require('one two')              stops with one message unless data/one.tsv, two.tsv are there
#   eval figure('name', 900, 600)        begins out/name.format of that many pixels
#   eval heading('title', 'subtitle')    its title, top left, on the next plot
#   escaped(name)                        a user's text for a title
#   eval panel(70, 60, 380, 300)         the next plot's axes: left, top, width, height in pixels
#   eval names_of('one')                 `names`: what is in the first column of data/one.tsv
#   slope_text(kind, slope, spread)      as many digits of a slope as mean something
#   plot ... lt style_of('cvode adams')  colour, dash and mark of a configuration
#   told = told_of('one', 'method error:m')   what a point of data/one.tsv says of itself, then
#   plot ... for [k = 1:has_tips] table('one') using x:y:(tip_of(told)) @TIP

set encoding utf8
set minussign
set datafile separator "\t"
table(name) = data.'/'.name.'.tsv'

# --- tables ---

shell(s) = strstrt(s, "'") ? s[1:strstrt(s, "'") - 1]."'\\''".shell(s[strstrt(s, "'") + 1:*]) : s
readable(path) = system("test -r '".shell(path)."' && echo yes") eq 'yes'
first_missing(list, i) = i > words(list) ? '' \
    : readable(table(word(list, i))) ? first_missing(list, i + 1) : table(word(list, i))
require(list) = first_missing(list, 1) eq '' ? 'missing = ""' \
    : 'exit error first_missing("'.list.'", 1).": no such table; run the experiment first"'

# Lists hold quoted words: a name may have spaces.
place(list, name) = sum [i = 1:words(list)] (word(list, i) eq name ? i : 0)
quoted(name) = ' "'.name.'"'
with_name(list, name) = name eq '' || place(list, name) ? list : list.quoted(name)
heads = '"method" "stepper" "name"' # the column's own name is no row
names_of(name) = 'names = ""; stats table("'.name.'") using ' \
    .'(names = place(heads, strcol(1)) ? names : with_name(names, strcol(1)), 0) nooutput'

# At most so many curves of a chart have a name: `chosen`, filled by named(chosen, name) with those
# that matter most first. Then eval part_names leaves them in `names`, in their own order, and the
# others in `rest`, whose curves are thin and grey (REST): they are in the table.
NAMED = 8
named(list, more) = words(list) < NAMED ? with_name(list, more) : list
part_names = 'rest = ""; own = ""; do for [m = 1:words(names)] { ' \
    .'if (place(chosen, word(names, m))) { own = own.quoted(word(names, m)) } ' \
    .'else { rest = rest.quoted(word(names, m)) } }; names = own'
rest_title(list) = words(list) ? sprintf('%d more, see the table', words(list)) : ''

# An adaptive method's slope only says how steep it is on the whole.
slope_text(kind, slope, spread) = kind eq 'adaptive' ? gprintf('≈ %.0f', slope) \
    : spread > 0.05 ? gprintf('≈ %.1f', slope) : gprintf('%.2f', slope)

# --- colour, dash and mark ---

# The program says how its configurations are drawn (integrators/configurations.c), whenever it
# draws: CONFIGURATIONS are their names, and in the same order there are COLOURS, INKS (the same,
# dark enough for text on white) and MARKS. Dashes go with marks, for print in grey.
array DASH[15] = ['(12,3,3,3,3,3)', 'solid', '(16,3,2,3)', '(4,3)', '(12,4)', '(5,3)', 'solid', \
                  '(5,2,1,2)', '(10,3,2,3)', '(8,3,2,3)', '(2.5,2.5)', '(2,3)', '(6,3)', '(9,3)', \
                  '(14,3,2,3,2,3)']
# A name that is not among them ('euler fine'; a table of another build's) has the colour of its
# first word, or grey, and takes its next mark in the order of appearance.
others = ''
OTHERS = 6
array other_mark[OTHERS] = [6, 1, 3, 4, 8, 14]
styled(i, v, colour, mark) = sprintf('set linetype %d lc rgb "%s" dt %s pt %d ps 0.85 lw 1.7', \
    100 + 10 * i + v, colour, DASH[mark], mark)
do for [i = 0:words(CONFIGURATIONS)] {
    colour = i ? word(COLOURS, i) : '#7F7F7F'
    eval styled(i, 0, colour, i ? int(word(MARKS, i)) : 7)
    do for [v = 1:OTHERS] { eval styled(i, v, colour, other_mark[v]) }
}
known(name) = place(CONFIGURATIONS, name)
family(name) = known(name) ? known(name) : known(word(name, 1))
other(name) = (others = with_name(others, name), (sum [i = 1:place(others, name) - 1] \
    (word(word(others, i), 1) eq word(name, 1))) % OTHERS + 1)
style_of(name) = name eq '' ? 100 : 100 + 10 * family(name) + (known(name) ? 0 : other(name))
mark_of(name) = known(name) ? int(word(MARKS, known(name))) : other_mark[other(name)]
colour_of(name) = family(name) ? word(COLOURS, family(name)) : '#7F7F7F'
ink_of(name) = family(name) ? word(INKS, family(name)) : '#5A5A5A'

# Points that say in an svg what they are, by their row of the table: told_of(table, columns) names
# the columns whose cells it says, each with its place in the table; the first stands as it is, the
# others on a line each with their name and, where "name:unit" has one, their unit. Where the table
# has a column `run`, a point leads to that run's record.
TIP = "with labels hypertext point pt 7 ps 1.2 lc rgb '#FF000000'"
has_tips = format eq 'svg' && paper eq ''
heads_of(name) = '"'.system("sed -n '/^#/!{s/\t/\" \"/g;p;q}' '".shell(table(name))."'").'"'
before_colon(w) = strstrt(w, ':') ? w[1:strstrt(w, ':') - 1] : w
after_colon(w) = strstrt(w, ':') ? w[strstrt(w, ':') + 1:*] : '-'
spaced(s) = strstrt(s, '_') ? s[1:strstrt(s, '_') - 1].' '.spaced(s[strstrt(s, '_') + 1:*]) : s
with_place(heads, w) = place(heads, before_colon(w)) ? sprintf(' %d "%s" "%s"', \
    place(heads, before_colon(w)), spaced(before_colon(w)), after_colon(w)) : ''
places_in(heads, list, i) = i > words(list) ? '' : with_place(heads, word(list, i)).places_in(heads, list, i + 1)
told_of(name, list) = sprintf('%d', place(heads_of(name), 'run')).places_in(heads_of(name), list, 1)
# A cell; of a number of many digits four. (A column() of words would take the point away.)
is_number(s) = strlen(s) > 6 && strstrt('0123456789-+.', s[1:1]) && !strstrt(s, ' ')
cell_text(c) = is_number(strcol(c)) ? sprintf('%.4g', column(c)) : strcol(c)
is_said(c) = strcol(c) ne '' && strcol(c) ne '-' && strcol(c) ne 'NaN' && strcol(c) ne 'nan'
line_of_cell(c, name, unit) = !is_said(c) ? '' : "\n".name.' '.cell_text(c).(unit eq '-' ? '' : ' '.unit)
lines_of(told, i) = i > words(told) ? '' \
    : line_of_cell(int(word(told, i)), word(told, i + 1), word(told, i + 2)).lines_of(told, i + 3)
run_of(c) = c > 0 && is_said(c) ? strcol(c) : '-'
tip_of(told) = run_of(int(word(told, 1)))."\n".strcol(int(word(told, 2))).lines_of(told, 5)
# The same in a script's own words, for a point that is no row.
tip(text) = "-\n".text

FAILED = 2          # mark of a run that failed: a cross, no stepper's mark
GREY = '#666666'    # words and lines that belong to no stepper
set linetype 1 lc rgb GREY dt solid pt 7 ps 0.85 lw 1.2
set linetype 2 lc rgb '#000000' dt (1.5,2.5) pt 6 ps 0.85 lw 1.5 # what is exact
REST = 3            # curves without a name
set linetype 3 lc rgb '#AAAAAA' dt solid pt 0 lw 0.8

# --- the page ---

WIDTH = 900; HEIGHT = 600
FONT = 'sans-serif' # DejaVu Sans here, the reader's own sans in an svg
# A png has the geometry of the svg at twice its pixels: sharp on paper and on fine screens.
# (Its points of 1/72 inch are 4/3 pixels, hence the 1.5; its marks are smaller, hence the 3.)
figure(name, width, height) = sprintf('reset; unset multiplot; WIDTH = %d; HEIGHT = %d; ', \
        paper eq 'draw' ? PAPER_WIDTH : width, paper eq 'draw' ? PAPER_HEIGHTS[PAPER_FIGURE + 1] : height) \
    .(paper eq '' ? screen_terminal(width, height) : paper eq 'survey' ? survey_terminal \
      : paper_terminal(PAPER_WIDTH, PAPER_HEIGHTS[PAPER_FIGURE + 1])) \
    .(paper eq 'survey' ? sprintf('print "figure %d %d %s"; ', width, height, name) : '') \
    .sprintf('set output out."/%s.%s"; ', name, format) \
    .'PAPER_FIGURE = PAPER_FIGURE + 1; PAPER_ITEM = 0; NARROWEST = 0; '.page
screen_terminal(width, height) = format eq 'svg' \
    ? sprintf('set terminal svg size %d,%d fixed enhanced font "%s,13" background "white"; ', \
              width, height, FONT) \
    : sprintf('set terminal pngcairo size %d,%d enhanced font "%s,13" fontscale 1.5 ' \
              .'linewidth 2 dashlength 2 pointscale 3 background "white"; ', 2 * width, 2 * height, FONT)
# gnuplot's own format of tics, '% h', has a space before a number, which then is not below its tic.
page = 'set border 3 lc rgb "#444444" lw 1; set tics nomirror out scale 0.6; ' \
    .'set grid lc rgb "#E2E2E2" lw 0.8 dt solid, lc rgb "#E2E2E2" lw 0.8 dt solid; ' \
    .'set key noautotitle noenhanced; set minussign; set format "%h"; ' \
    .'set datafile separator "\t"; set encoding utf8'

# A user's text as it is: no character in it is markup.
escaped(s) = s eq '' ? '' : (strstrt('_^@&{}~\', s[1:1]) ? "\\" : '').s[1:1].escaped(s[2:*])

heading(title, subtitle) = (TITLE = title, SUBTITLE = subtitle, paper ne '' ? '' : \
    'set label 1 "{/=16:Bold ".TITLE."}" at screen 12./WIDTH, screen 1 - 20./HEIGHT left; ' \
    .'set label 2 SUBTITLE at screen 12./WIDTH, screen 1 - 43./HEIGHT left textcolor rgb GREY')
heading_done = 'unset label 1; unset label 2' # in a multiplot, after the first panel
panel(left, top, width, height) = paper eq '' ? framed(left, top, width, height) \
    : paper eq 'survey' ? 'SHOWN = 0; '.survey('panel', left, top, width, height, NARROWEST) \
    : (PAPER_ITEM = PAPER_ITEM + 1, SHOWN = item(3) > 0, SHOWN ? framed(item(1), item(2), item(3), item(4)) : '')
framed(left, top, width, height) = sprintf( \
    'set lmargin at screen %.6f; set rmargin at screen %.6f; ' \
    .'set tmargin at screen %.6f; set bmargin at screen %.6f', left / (1. * WIDTH), \
    (left + width) / (1. * WIDTH), 1 - top / (1. * HEIGHT), 1 - (top + height) / (1. * HEIGHT))
# A panel that holds only a legend: eval legend(...), then plot @BLANK, keyentry ...; gnuplot wants
# something to plot besides.
BLANK = '0 with dots lc bgnd'
legend(left, top, width, height, rows) = paper eq '' \
    ? framed(left, top, width, height).'; '.BARE.key_at(left, top, width, height, rows) \
    : paper eq 'survey' ? framed(0, 0, WIDTH, HEIGHT).'; '.BARE.survey('legend', left, top, width, height, rows) \
    : (PAPER_ITEM = PAPER_ITEM + 1, framed(item(1), item(2), item(3), item(4)).'; '.BARE \
       .key_at(item(1), item(2), item(3), item(4), item(5)))
BARE = 'set samples 2; unset border; unset tics; unset grid; unset logscale; unset label; unset arrow; unset title; ' \
    .'unset xlabel; unset ylabel; unset object; set size noratio; set xrange [0:1]; set yrange [0:1]; '
key_at(left, top, width, height, rows) = sprintf( \
    'set key at screen %.6f, %.6f center center horizontal Left reverse maxrows %d ', \
    (left + width / 2.) / WIDTH, 1 - (top + height / 2.) / HEIGHT, rows).'samplen 3 spacing 1.15 width 1'
# The legend of a figure that is one panel, which has it on itself: only on paper it is elsewhere.
# There it has so many names, of so many letters at most.
own_key(names, longest, screen) = paper eq '' ? screen \
    : paper eq 'survey' ? sprintf('print "legend 0 0 0 0 1 %d %d"', names, longest) \
    : (PAPER_ITEM = PAPER_ITEM + 1, key_at(item(1), item(2), item(3), item(4), item(5)))

# --- for papers ---

# `wisplab plot --paper` calls a script twice. With paper = 'survey' every figure, panel and legend
# says where it is on the screen, and the legends alone are drawn, each 1500 units below the one
# before, so that it can be seen how many names they have and how long these are. From that
# src/picture/paper.c makes, for paper = 'draw', PAPER_HEIGHTS and PAPER_PLACES: of each panel and
# legend, in this order, left, top, width and height (0: left out), then of a panel whether it is the
# first of its row and the last of its column, of a legend its rows. On paper a unit, a pixel of the
# screen, is 7/11 pt: letters of 13 and 11 units have 8 and 7 pt.
PAPER_UNIT = 7 / 11. / 72 # inch
survey_terminal = sprintf('set terminal svg size 4000,60000 fixed enhanced font "%s,13"; ', FONT)
survey(what, left, top, width, height, rows) = (PAPER_ITEM = PAPER_ITEM + 1, \
    sprintf('print "%s %g %g %g %g %g"', what, left, top, width, height, rows) \
    .(what eq 'legend' ? sprintf('; set key at screen 0.5, %.6f center top Left reverse maxrows 99', \
                                 1 - (1500. * PAPER_ITEM + 100) / 60000) : ''))
item(k) = real(word(PAPER_PLACES[PAPER_FIGURE], 6 * (PAPER_ITEM - 1) + k))
# Each terminal has units of its own for letters, lines and marks; these make them those of an svg.
paper_terminal(width, height) = format eq 'svg' \
    ? sprintf('set terminal svg size %d,%d fixed enhanced font "%s,12.57" background "white"; ', \
              width, height, FONT) \
    : format eq 'pdf' \
    ? sprintf('set terminal pdfcairo size %.4fin,%.4fin enhanced font "%s,12.57" fontscale %.5f ' \
              .'linewidth %.5f dashlength %.5f pointscale %.5f; ', width * PAPER_UNIT, height * PAPER_UNIT, FONT, \
              0.75 * PAPER_UNIT * 72, PDF_LINE, 1.3 * PDF_LINE, PDF_POINT) \
    : sprintf('set terminal pngcairo size %d,%d enhanced font "%s,12.57" fontscale %.5f ' \
              .'linewidth %.5f dashlength %.5f pointscale %.5f background "white"; ', \
              300 * width * PAPER_UNIT, 300 * height * PAPER_UNIT, FONT, 0.75 * 300 * PAPER_UNIT, 300 * PAPER_UNIT, 300 * PAPER_UNIT, \
              1.5 * 300 * PAPER_UNIT)
PDF_LINE = 2 * PAPER_UNIT * 72; PDF_POINT = 1.5 * PAPER_UNIT * 72
# NARROWEST is what part of their width panels can do with, with their shape kept; 0: what is usual. How
# wide the panel is on paper, and on the screen without end:
paper_width(any) = paper eq 'draw' ? item(3) : 1e6
# A place between titles and panels, so many pixels below the top; on paper there are no titles.
below(pixels) = 1 - (pixels - (paper eq '' ? 0. : 52.)) / HEIGHT
SPREAD = paper eq '' ? ': median, least to greatest' : '' # the caption's task on paper
# Whether a panel has the words of its row's axis, and those of its column's: `here` on the screen.
leftmost(here) = paper eq 'draw' ? item(5) == 1 : here
lowest(here) = paper eq 'draw' ? item(6) == 1 : here
PAPER_FIGURE = 0; PAPER_ITEM = 0; SHOWN = 1
if (paper ne '') { load layout }
in_column = paper eq 'draw' ? PAPER_WIDTH < 500 : 0

powers(axis) = sprintf('set logscale %s; set format %s "10^{%%T}"; set m%stics default', axis, axis, axis)
