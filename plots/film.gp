# A film of the pictures 000001.png, 000002.png, ... in `data`, which page.gp there describes.

load data.'/page.gp'
set terminal gif animate delay delay loop 0 size WIDTH,HEIGHT
set output out.'/film.gif'
unset border; unset tics; unset key
set lmargin at screen 0; set rmargin at screen 1; set bmargin at screen 0; set tmargin at screen 1
set xrange [0:WIDTH]; set yrange [0:HEIGHT]
# A GIF has 256 colours, which gnuplot gives to those that come first: so there must not be more.
few(v) = 25.5 * int(v / 25.5 + 0.5)
do for [i = 1:pictures] {
    plot sprintf('%s/%06d.png', data, i) binary filetype=png origin=(0.5,0.5) dx=1 dy=1 \
        using (few($1)):(few($2)):(few($3)) with rgbimage
}
unset output
