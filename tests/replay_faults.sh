#!/bin/bash
# Plants each fault of faults.tsv in a copy of the tree, builds it, and demands that the named tests
# fail: a gate that nothing can turn red is no gate. The faultless copy must pass the same tests.
#
#   tests/replay_faults.sh [WORD]      only faults whose line contains WORD
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
word=${1-}
work=$(mktemp -d "${TMPDIR:-/tmp}/wisplab-faults-XXXXXX")
trap 'stop_leftovers; rm -rf "$work"' EXIT
export TMPDIR=$work LC_ALL=C

# A fault can make a run that nothing ends, and whoever started it has died by then.
stop_leftovers() {
    local exe
    for exe in /proc/[0-9]*/exe; do
        case $(readlink "$exe" 2>/dev/null || true) in
        "$work"/*) kill -9 "$(basename "$(dirname "$exe")")" 2>/dev/null || true ;;
        esac
    done
}

say() { printf '%s\n' "$*"; }

# The last lines of a log, and out.
give_up() {
    tail -n 20 "$work/log" >&2
    say "replay_faults.sh: $1" >&2
    exit 2
}

build() { cmake --build "$work/build" --target wisplab-tests >"$work/log" 2>&1; }

# 0: all passed, and there were some; else they failed, hung or died.
run() {
    timeout 100 "$work/build/wisplab-tests" --jobs 2 --filter "$1" >"$work/log" 2>&1 </dev/null &&
        ! grep -q 'Tested: 0 ' "$work/log"
}

mkdir "$work/tree"
tar -C "$here" --exclude='./build*' --exclude=./results --exclude=./.git -cf - . |
    tar -C "$work/tree" -xf -
cmake -S "$work/tree" -B "$work/build" -G Ninja >"$work/log" 2>&1 || give_up "cannot configure"
build || give_up "the tree does not build as it is"

rows() { grep -v '^#' "$work/tree/tests/faults.tsv" | grep -F -- "$word" || true; }
while IFS= read -r filter; do
    run "$filter" || give_up "$filter fails without any fault"
done < <(rows | awk -F'\t' '{ print $4 }' | sort -u)

faults=0 caught=0
while IFS= read -r line; do
    # by hand, for read joins tabs, and a fault that removes its text has an empty field
    file=${line%%$'\t'*} line=${line#*$'\t'}
    text=${line%%$'\t'*} line=${line#*$'\t'}
    instead=${line%%$'\t'*} filter=${line#*$'\t'}
    path=$work/tree/$file
    cp "$path" "$work/good"
    content=$(cat "$path"; printf x)
    content=${content%x}
    without=${content//"$text"/}
    count=$(((${#content} - ${#without}) / ${#text}))
    if [ "$count" != 1 ]; then
        say "replay_faults.sh: $file has '$text' $count times, not once" >&2
        exit 2
    fi
    printf '%s' "${content/"$text"/"$instead"}" >"$path"
    build || give_up "$file does not build with '$instead'"
    faults=$((faults + 1))
    if run "$filter"; then
        say "MISSED  $file: '$text' -> '$instead' ($filter)"
    else
        caught=$((caught + 1))
        say "caught  $file: '$text' -> '$instead' ($filter)"
    fi
    stop_leftovers
    cp "$work/good" "$path"
done < <(rows)

say "$faults faults, $caught caught"
[ "$faults" -gt 0 ] && [ "$faults" = "$caught" ]
