#!/bin/bash
# How large a report's page is to read: measured in headless chromium, with screenshots.
#
#   tests/page.sh PAGE FOLDER [SCREENS KILOBYTES PRINTED]
#
# PAGE is a report.html, or the program, which then makes one with --quick; FOLDER gets wide.png
# (1280 px), phone.png (400 px) and print.pdf. Prints one line for each number. With limits (screens
# of 1280 x 800, kilobytes, printed pages; a full report: 40 12000 -, where - is none) exit code 1
# where one is passed, and also where
#   a phone's page is wider than the phone, or a box in it goes on where nothing says so,
#   a figure's letters are smaller than 10 px there, or go beyond the figure,
#   on paper a table is wider than that, or a number of one is broken over two lines.
# Before it measures a page of the program it tries all limits on a page that passes each.
# Exit code 77 where there is no chromium.
set -euo pipefail
page=$(realpath "$1") folder=$2
limits=("${@:3}")
browser=$(command -v chromium || command -v chromium-browser) || {
    echo "page.sh: no chromium here: not measured"
    exit 77
}
mkdir -p "$folder"
folder=$(realpath "$folder")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# A page on which everything is wrong that is looked for, and whether each is found.
try_limits() {
    local number fault
    number=$(printf '1.2345678901e-05%.0s' {1..99})
    cat >"$work/bad.html" <<HTML
<!DOCTYPE html><html><head><style>@media print{td{word-break:break-all}}</style></head>
<body style="margin:0"><p style="height:1700px;width:900px;break-after:page">wide and tall</p>
<div style="overflow:hidden;width:100px"><div style="width:300px">goes on</div></div>
<svg width="200" height="50" viewBox="0 0 400 100"><text x="380" y="40" font-size="12">beyond the
edge</text></svg><table><tr><td>$number</td></tr></table></body></html>
HTML
    "$0" "$work/bad.html" "$work/bad" 1 0 1 >"$work/bad.txt" || true
    for fault in screens kilobytes "printed pages" "width on a phone" "smallest letter" \
        "beyond their figures" "go on without" "broken on paper" "width on paper"; do
        grep -q "^page.sh: .*$fault.*" "$work/bad.txt" || {
            echo "page.sh: does not see what it should: $fault"
            cat "$work/bad.txt"
            exit 1
        }
    done
}

if [ -x "$page" ]; then
    try_limits
    WISPLAB_HOST=page-$$ "$page" report --quick --no-progress --out "$work/results" >"$work/words"
    page=$work/results/report.html
    tables=$(dirname "${BASH_SOURCE[0]}")/tables.py # every experiment's, where there is pandas
    /usr/bin/python3 "$tables" "$work"/results/*/ || [ $? = 77 ]
fi

# Runs the browser on a page with a window of that size.
browse() {
    local size=$1
    shift
    timeout 120 "$browser" --headless --no-sandbox --disable-gpu --hide-scrollbars \
        --user-data-dir="$work/profile" --window-size="$size" "$@" 2>"$work/words"
}

# The page says of itself: its height and width; the smallest letter in any figure that shows, and
# how many texts go beyond theirs; how many boxes go on where nothing is seen of it (a word before
# them, or a shadow), and how many numbers of tables are broken.
cat >"$work/measure.js" <<'JS'
addEventListener("load", () => {
    const root = document.documentElement;
    let letter = Infinity, beyond = 0, unsigned = 0, broken = 0;
    for (const svg of document.querySelectorAll("svg")) {
        const box = svg.getBoundingClientRect();
        const natural = svg.viewBox.baseVal.width;
        if (box.width === 0 || natural === 0)
            continue;
        for (const text of svg.querySelectorAll("text")) {
            const size = parseFloat(getComputedStyle(text.querySelector("tspan") || text).fontSize);
            const own = text.getBoundingClientRect();
            if (text.textContent.trim().length > 3)
                letter = Math.min(letter, size * box.width / natural);
            if (own.right > box.right + 1 || own.left < box.left - 1)
                beyond++;
        }
    }
    for (const box of document.querySelectorAll("body *")) {
        if (box.scrollWidth <= box.clientWidth + 1 || box.clientWidth === 0 || box.closest("svg") ||
            getComputedStyle(box).overflowX === "visible")
            continue;
        const before = getComputedStyle(box, "::before").content;
        if ((before === "none" || before === "normal") &&
            getComputedStyle(box).backgroundImage === "none")
            unsigned++;
    }
    for (const cell of document.querySelectorAll("td, th")) {
        const walker = document.createTreeWalker(cell, NodeFilter.SHOW_TEXT);
        for (let text; (text = walker.nextNode());)
            for (const found of text.data.matchAll(/[-−]?\d+(?:[.,]\d+)*(?:e[-+]?\d+)?/gi)) {
                const range = document.createRange();
                range.setStart(text, found.index);
                range.setEnd(text, found.index + found[0].length);
                broken += new Set(Array.from(range.getClientRects(), r => r.top)).size > 1;
            }
    }
    const loading = performance.getEntriesByType("navigation")[0];
    const numbers = {height: root.scrollHeight, width: root.scrollWidth, letter: letter.toFixed(1),
                     beyond, unsigned, broken, load: Math.round(loading.domComplete)};
    const text = Object.keys(numbers).map(k => "measured " + k + " " + numbers[k]).join("\n");
    if (parent === window)
        document.body.appendChild(document.createElement("pre")).textContent = text;
    else
        parent.postMessage(text, "*");
});
JS
# with_measure FILE: the page, with what it says of itself.
with_measure() {
    sed 's,</body>.*,,' "$1"
    echo "<script>"
    cat "$work/measure.js"
    echo "</script></body></html>"
}
with_measure "$page" >"$work/page.html"
sed 's/@media print/@media all/' "$page" >"$work/printed.html"
with_measure "$work/printed.html" >"$work/sheet.html"

# The browser has no window as narrow as a phone or a sheet of A4 within its margins, and so these
# are frames in one.
# frame PAGE WIDTH HEIGHT
frame() {
    cat <<HTML
<!DOCTYPE html><html><body style="margin:0"><iframe src="$1" style="width:$2px;height:$3px;border:0"></iframe>
<script>
addEventListener("message", event => {
    document.body.appendChild(document.createElement("pre")).textContent = event.data;
});
</script></body></html>
HTML
}
PHONE=400 PAPER=718
frame page.html $PHONE 800 >"$work/phone.html"
frame sheet.html $PAPER 1000 >"$work/paper.html"

# measured page|phone|paper NAME: one of the numbers above.
measured() {
    [ -f "$work/$1.dom" ] ||
        browse 1280,800 --virtual-time-budget=10000 --dump-dom "file://$work/$1.html" >"$work/$1.dom"
    sed -n -E "s/.*measured $2 ([0-9.]+|Infinity).*/\1/p" "$work/$1.dom" | tail -1
}

height=$(measured page height)
screens=$(((height + 799) / 800))
kilobytes=$((($(stat -c %s "$page") + 999) / 1000))
browse 1280,800 --no-pdf-header-footer --print-to-pdf="$folder/print.pdf" "file://$page" >/dev/null
printed=$(grep -a -c -E '/Type ?/Page([^s]|$)' "$folder/print.pdf")
phone_width=$(measured phone width)
letter=$(measured phone letter)
beyond=$(measured page beyond)
unsigned=$(measured phone unsigned)
paper_width=$(measured paper width)
broken=$(measured paper broken)
browse "1280,$((height < 16000 ? height : 16000))" --screenshot="$folder/wide.png" "file://$page" >/dev/null
phone_height=$(measured phone height)
frame "file://$page" $PHONE "$phone_height" >"$work/shown.html"
browse "500,$((phone_height < 16000 ? phone_height : 16000))" --screenshot="$folder/phone.png" \
    "file://$work/shown.html" >/dev/null

echo "screens at 1280 px: $screens"
echo "kilobytes: $kilobytes"
echo "printed pages: $printed"
echo "texts beyond their figures: $beyond"
echo "width on a phone of $PHONE px: $phone_width"
echo "boxes that go on without a sign there: $unsigned"
echo "smallest letter in a figure there: $letter px"
echo "width on paper of $PAPER px: $paper_width"
echo "numbers broken on paper: $broken"
echo "loaded after: $(measured page load) ms" # says more of the machine than of the page

code=0
# passes NUMBER LIMIT WHAT
passes() {
    if [ "$2" != - ] && awk "BEGIN { exit !($1 > $2) }"; then
        echo "page.sh: $3: $1, and at most $2 is wanted"
        code=1
    fi
}
if [ "${#limits[@]}" = 3 ]; then
    passes "$screens" "${limits[0]}" "screens"
    passes "$kilobytes" "${limits[1]}" "kilobytes"
    passes "$printed" "${limits[2]}" "printed pages"
    passes "$beyond" 0 "texts that go beyond their figures"
    passes "$phone_width" $PHONE "width on a phone"
    passes "$unsigned" 0 "boxes that go on without a sign on a phone"
    passes 10 "$letter" "ten pixels, against the smallest letter"
    passes "$paper_width" $PAPER "width on paper"
    passes "$broken" 0 "numbers broken on paper"
fi
exit $code
