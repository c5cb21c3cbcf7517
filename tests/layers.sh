#!/bin/bash
# No folder includes or calls one above it.
#
#   tests/layers.sh TREE [OBJECTS]
#
# TREE is the source tree; OBJECTS a folder with its compiled files (build/CMakeFiles), whose
# undefined symbols are looked up among those that the others define. Each wrong arrow is a line;
# exit 1 where there is one.
set -euo pipefail
export LC_ALL=C
tree=$1 objects=${2-}

# From the bottom up. Folders on one line are neighbours, and do not know of each other. bench is
# the second program, as command is the first.
layers='
src/base
src/system
integrators/linear
integrators
src/wisp
src/kernel
src/model
src/scene
src/run
src/picture src/library
experiments/common
experiments/chapter5 experiments/contact_rate experiments/history experiments/ladder experiments/needs experiments/speed experiments/stability experiments/sweep experiments/work_precision
experiments
src/report
src/command experiments/bench
'

# file <tab> folder that it needs <tab> why
includes() {
    (cd "$tree" && find src integrators experiments -name '*.[ch]' | sort | xargs grep -HoE '^ *#include "[^"]+/[^"/]+"') |
        sed -E 's,^([^:]+):[^"]*"(.*)/([^/]+)"$,\1\t\2\t\3,' |
        awk -F'\t' -v OFS='\t' '
            { if ($2 !~ /^(integrators|experiments)(\/|$)/) $2 = "src/" $2
              print $1, $2, "includes " $2 "/" $3 }'
}

# Symbols by source file: T where it is defined, U where it is wanted. What was compiled of a source
# that is no more does not count.
symbols() {
    find "$objects" \( -path '*/wisplab-core.dir/*' -o -path '*/kernel-*.dir/*' -o \
        -path '*/wisplab.dir/*' -o -path '*/libwisplab.dir/*' \) -name '*.c.o' -print0 | sort -z | xargs -0 nm -A -P -g |
        sed -E 's,^[^ ]*\.dir/([^ ]*)\.o: ([^ ]+) ([A-Z]).*,\3\t\2\t\1,; s,^[^U],T,' |
        awk -F'\t' -v tree="$tree" '
            !($3 in there) { there[$3] = system("test -f \"" tree "/" $3 "\"") == 0 }
            there[$3]'
}

calls() {
    [ -n "$objects" ] || return 0
    symbols | sort -t "$(printf '\t')" -k1,1 | awk -F'\t' -v OFS='\t' '
        function folder(path) { sub(/\/[^\/]*$/, "", path); return path }
        $1 == "T" { at[$2] = $3; next }
        ($2 in at) && !(($3, $2) in seen) {
            seen[$3, $2] = 1
            print $3, folder(at[$2]), "uses " $2 " of " at[$2]
        }'
}

{ includes; calls; } | awk -F'\t' -v layers="$layers" '
    BEGIN {
        n = split(layers, line, "\n")
        for (i = 1; i <= n; i++) {
            m = split(line[i], name, " ")
            for (k = 1; k <= m; k++) height[name[k]] = i
        }
    }
    {
        count++
        from = $1
        sub(/\/[^\/]*$/, "", from)
        if (!(from in height)) { print $1 ": its folder is in no layer"; bad = 1; next }
        if (!($2 in height)) { print $1 ": " $3 ": that folder is in no layer"; bad = 1; next }
        if (from == $2 || height[$2] < height[from]) next
        print $1 ": " $3 ", which is " (height[$2] == height[from] ? "beside" : "above") " it"
        bad = 1
    }
    END {
        if (!count) print "nothing to look at"
        exit bad || !count
    }'
