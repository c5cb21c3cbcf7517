#!/bin/bash
# The long run of the fuzz targets, under the address and undefined-behaviour sanitizers: a million
# scenes, a hundred thousand of each other kind of file. An input that crashes, hangs, leaks or is
# refused in more than one line ends it, and stands in build-fuzz/found.
#
#   tests/fuzz/run.sh               from what the last one has found, in build-fuzz/corpus
#   tests/fuzz/run.sh --seconds N   each target for so long instead
#   tests/fuzz/run.sh --coverage    which share of each reader's lines the corpus goes through
#   tests/fuzz/run.sh --faults      plants the faults of tests/fuzz/faults.tsv in a copy of the tree:
#                                   each must be found within a minute, from the corpus
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
here=$PWD
readers="src/scene/config*.c src/scene/scene_[clrsw]*.c src/scene/setting_read.c src/base/table.c src/base/npy.c src/base/text_table.c src/base/visible.c
         src/model/trajectory.c src/model/state.c src/run/results.c src/run/seal.c
         src/picture/frames.c"

say() { printf '%s\n' "$*"; }

# The corpus of a kind of file.
seeds() {
    echo "tests/fuzz/corpus/$1"
    [ "$1" != scene ] || mkdir -p build-fuzz/shipped
    [ "$1" != scene ] || cp experiments/*.cfg build-fuzz/shipped
    [ "$1" != scene ] || echo build-fuzz/shipped
}

build() {
    cmake --preset fuzz >build-fuzz.log && cmake --build --preset fuzz >>build-fuzz.log ||
        { tail -n 20 build-fuzz.log >&2; exit 2; }
    rm build-fuzz.log
}

# Target, and libFuzzer's options.
fuzz() {
    local kind=$1
    shift
    mkdir -p "build-fuzz/corpus/$kind" build-fuzz/found
    build-fuzz/fuzz-$kind -dict=tests/fuzz/$kind.dict -max_len=4096 -timeout=10 -rss_limit_mb=2048 \
        -artifact_prefix=build-fuzz/found/$kind- -print_final_stats=1 "$@" \
        "build-fuzz/corpus/$kind" $(seeds "$kind") >build-fuzz/$kind.log 2>&1
}

long_run() {
    local kind runs status=0
    build
    for kind in scene states run table; do
        runs=100000
        [ $kind != scene ] || runs=1000000
        if [ -n "$1" ]; then runs=-1; fi
        fuzz $kind -runs=$runs ${1:+-max_total_time=$1} || { status=1; tail -n 40 build-fuzz/$kind.log; }
        say "$kind: $(sed -n 's/^stat::number_of_executed_units: *//p' build-fuzz/$kind.log) inputs," \
            "$(ls build-fuzz/corpus/$kind | wc -l) kept"
    done
    return $status
}

# gcc's counts of lines.
coverage() {
    local kind file percent bad=0
    cmake -S . -B build-coverage -G Ninja -DCMAKE_BUILD_TYPE=Debug -DCMAKE_C_FLAGS="--coverage -O0" \
        -DCMAKE_EXE_LINKER_FLAGS=--coverage >/dev/null
    cmake --build build-coverage --target fuzz-scene fuzz-states fuzz-run fuzz-table >/dev/null
    find build-coverage -name '*.gcda' -delete
    for kind in scene states run table; do
        build-coverage/fuzz-$kind $(seeds $kind) >/dev/null
    done
    for file in $readers; do
        percent=$(gcov -n -o "build-coverage/CMakeFiles/wisplab-core.dir/${file%/*}" \
            "build-coverage/CMakeFiles/wisplab-core.dir/$file.gcda" 2>/dev/null |
            grep -A1 "File '.*$file'" | sed -n 's/^Lines executed:\(.*\)% of \(.*\)$/\1 \2/p')
        say "$file ${percent:-0 0}"
    done | awk '{ printf "%6.1f %% of %4d lines  %s\n", $2, $3, $1; done += $2 * $3; all += $3 }
        END { printf "%6.1f %% of %4d lines\n", done / all, all; exit done / all < 90 }'
}

# A fault a line: file, its text (there once), what takes its place, the target that must find it.
faults() {
    local file text instead kind work all=0 found=0
    work=$(mktemp -d "${TMPDIR:-/tmp}/wisplab-fuzz-XXXXXX")
    trap 'rm -rf "$work"' EXIT
    tar --exclude='./build*' --exclude=./results --exclude=./.git -cf - . | tar -C "$work" -xf -
    cd "$work"
    while IFS= read -r line; do
        file=${line%%$'\t'*} line=${line#*$'\t'}
        text=${line%%$'\t'*} line=${line#*$'\t'}
        instead=${line%%$'\t'*} kind=${line#*$'\t'}
        content=$(cat "$here/$file"; printf x)
        content=${content%x}
        without=${content//"$text"/}
        [ $(((${#content} - ${#without}) / ${#text})) = 1 ] || { say "$file has not once '$text'"; exit 2; }
        printf '%s' "${content/"$text"/"$instead"}" >"$file"
        build
        all=$((all + 1))
        rm -rf build-fuzz/corpus build-fuzz/found
        local begin=$SECONDS
        if fuzz $kind -max_total_time=60; then
            say "MISSED  $file: '$text' -> '$instead' ($kind)"
        else
            found=$((found + 1))
            say "found   after $((SECONDS - begin)) s: $file: '$text' -> '$instead' ($kind)"
        fi
        cp "$here/$file" "$file"
    done < <(grep -v '^#' "$here/tests/fuzz/faults.tsv")
    say "$all faults, $found found"
    [ $all = $found ]
}

case ${1-} in
'') long_run "" ;;
--seconds) long_run "$2" ;;
--coverage) coverage ;;
--faults) faults ;;
*) sed -n '2,/^set/s/^# \{0,1\}//p' "$0" >&2; exit 1 ;;
esac
