# Pages of pictures of hair, of what `wisplab render` has put into `data`: page.gp says where the
# panels are and which files they have; these hold an image of the bodies and segments, from back to
# front, in pixels.

load plots.'/style.gp'
load data.'/page.gp'

if (format eq 'svg') {
    set terminal svg size WIDTH,HEIGHT fixed enhanced font FONT.',12' background 'white' rounded
} else {
    set terminal pngcairo size WIDTH,HEIGHT enhanced font FONT.',10' background 'white' rounded
}
set output out.'/picture.'.format
set multiplot
unset border; unset tics; unset key; unset grid; unset colorbox
set xrange [0:1]; set yrange [0:1]
eval panel(0, 0, WIDTH, HEIGHT)
plot @BLANK
unset label

# Segments as struct segment has them: x y dx dy depth error colour number.
RECORD = 'format="%float%float%float%float%float%float%uint32%uint32"'
file(name) = data.'/'.name
# Distances over four decades, from pale to dark.
if (most > 0) {
    set palette defined (0 '#F2C14E', 1 '#F08A4B', 2 '#CC4778', 3 '#7E03A8', 4 '#0D0887')
    highest = 10**ceil(log10(most)); lowest = highest / 1e4
    set logscale cb; set cbrange [lowest:highest]
    hair = 'using 1:2:3:4:($6 > lowest ? $6 : lowest) with vectors nohead lc palette'
    dots = 'using 1:2:($6 > lowest ? $6 : lowest) with points pt 7 ps 0.5 lc palette'
} else {
    hair = 'using 1:2:3:4:7 with vectors nohead lc rgb variable'
    dots = 'using 1:2:7 with points pt 7 ps 0.5 lc rgb variable'
}
# A hair is as thick as a pixel of a picture of some 700 lines.
thick = panel_height / 700.; thick = thick < 0.6 ? 0.6 : thick > 3 ? 3 : thick
set xrange [0:panel_width]; set yrange [0:panel_height]
do for [i = 1:panels] {
    eval panel(left[i], top[i], panel_width, panel_height)
    if (layer0[i] ne '') {
        plot file(layer0[i]) binary @RECORD using 1:2:3:4:7 with vectors filled head size 7,18,60 fixed \
            lw 1.6 lc rgb variable
    }
    if (bodies[i]) {
        plot file(image[i]) binary array=(panel_width,panel_height) format='%uchar' \
            origin=(0.5,0.5) dx=1 dy=1 using 1:2:3:4 with rgbalpha
    }
    if (layer1[i] ne '') { plot file(layer1[i]) binary @RECORD @hair lw thick }
    if (layer2[i] ne '') { plot file(layer2[i]) binary @RECORD @hair lw 1 }
    if (layer3[i] ne '') { plot file(layer3[i]) binary @RECORD @hair lw 3 }
    if (layer4[i] ne '') { plot file(layer4[i]) binary @RECORD @dots }
}
if (most > 0) {
    eval panel(0, HEIGHT - 70, WIDTH, 70)
    set colorbox user horizontal origin screen 0.5 - 160./WIDTH, screen 50./HEIGHT \
        size screen 320./WIDTH, screen 10./HEIGHT
    set cbtics nomirror out scale 0.5; set format cb '10^{%T}'; unset mcbtics
    set cblabel 'distance from the reference, m' offset 0, 0.5
    plot '+' using 1:(NaN):(most) with points lc palette
}
unset multiplot
unset output
