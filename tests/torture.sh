#!/bin/bash
# What a night on a shared cluster can do to an experiment: kill -9 at random moments, two processes
# and two hosts on one folder, a full disk, small limits. After each, the same command without it
# must end with every run there once, whole, and all tables equal to those of a quiet run but for
# CPU times. The experiment is `circle --quick`: 92 runs, tables and figures in five seconds, so
# that a hundred kills meet each of its moments.
#
#   tests/torture.sh [--short] [PROGRAM]      PROGRAM: build/wisplab; KILLS=100, SEED=1 (environment)
#
# About ten minutes on an idle machine; --short, for ctest, is one, with few kills and one method.
set -uo pipefail
export LC_ALL=C
what=(circle --quick) kills=${KILLS:-100} short=
[ "${1-}" = --short ] && { shift && short=yes kills=${KILLS:-4} && what+=(--stepper euler); }
program=$(realpath -e "${1:-$(dirname "$0")/../build/wisplab}") || exit 2
work=$(mktemp -d "${TMPDIR:-/tmp}/wisplab-torture-XXXXXX")
RANDOM=${SEED:-1}
failures=0 mounted=
clean() {
    [ -z "$mounted" ] || umount "$mounted"
    if [ "$failures" = 0 ]; then rm -rf "$work"; else echo "torture.sh: left for a look: $work"; fi
}
trap clean EXIT
cd "$work" || exit 2
unset WISPLAB_HOST

# A copy, for one that is built anew meanwhile is another program, with runs of its own.
mkdir bin && cp "$program" bin/wisplab || exit 2
[ ! -d "${program%/*}/../share" ] || ln -s "${program%/*}/../share" share
program=$work/bin/wisplab

fail() {
    echo "torture.sh: FAILED: $*"
    failures=$((failures + 1))
}

# In a folder, with what is said beside it; the second form is for the background, and to be killed.
experiment() {
    "$program" experiment "${what[@]}" --no-progress --out "$1" >"$1.out" 2>"$1.err"
}
be_experiment() {
    exec "$program" experiment "${what[@]}" --no-progress --out "$1" >"$1.out" 2>"$1.err"
}

# What is to be the same: a table without its CPU times, a run.json without its times.
lasting() {
    case $1 in
    *.tsv) awk -F'\t' '
        /^#/ { print; next }
        !named { for (i = 1; i <= NF; i++) drop[i] = $i ~ /^cpu_/; named = 1 }
        { for (i = 1; i <= NF; i++) if (!drop[i]) printf "%s\t", $i; print "" }' "$1" ;;
    *) awk '
        /^  "(seconds|cpu_seconds_repeated)":/ { inside = 1 }
        !inside && !/^  "(cpu_seconds|seal)":/ { print }
        /^  []}]/ { inside = 0 }' "$1" ;;
    esac
}

# A folder against the quiet one: the same files, and the same in them.
compare() {
    local folder=$1 after=$2 name
    if ! diff <(cd quiet && find . -type f ! -name .lock | sort) \
              <(cd "$folder" && find . -type f ! -name .lock | sort) >"$folder.diff"; then
        fail "$after: other files: $(head -c 500 "$folder.diff" | tr '\n' ' ')"
        return
    fi
    while read -r name; do
        cmp -s <(lasting "quiet/$name") <(lasting "$folder/$name") || fail "$after: $name is another"
    done < <(cd "$folder" && find . -name '*.tsv' -o -name run.json)
}

# The same command, undisturbed, and what it leaves. With what was before as the last word.
finish() {
    local folder=$1 after=$2
    experiment "$folder" || fail "$after: exit code $?: $(cat "$folder.err")"
    compare "$folder" "$after"
}

# Milliseconds.
now() { echo $(($(date +%s%N) / 1000000)); }
pause() { sleep "$(printf '%d.%03d' $(($1 / 1000)) $(($1 % 1000)))"; }

begin=$(now)
mkdir quiet
experiment quiet || { fail "a quiet run: $(cat quiet.err)"; exit 1; }
whole=$(($(now) - begin))
mkdir again && finish again "another quiet run" && rm -rf again
echo "quiet: $(ls quiet/runs | wc -l) runs in $whole ms"

# --- kill -9 ---
# At any moment from the start to the end of a quiet run, again and again into the same folder; one
# that gets to its end before is looked at, and a new one begun.
killed=0 ended=0
mkdir killed
while [ "$killed" -lt "$kills" ]; do
    be_experiment killed &
    child=$!
    pause $((RANDOM * 32768 % whole + RANDOM % 100))
    kill -9 "$child" 2>/dev/null
    wait "$child" 2>/dev/null
    case $? in
    137) killed=$((killed + 1)) ;;
    0)
        ended=$((ended + 1))
        compare killed "$killed kills"
        rm -rf killed && mkdir killed
        ;;
    *) fail "after $killed kills: $(cat killed.err)" ;;
    esac
done
finish killed "the last kill"
echo "kill -9: $killed times; $ended times it was done before"

# --- two processes, and two hosts, on one folder ---
together() {
    local folder=$1 other=$2 new
    mkdir "$folder" && ln -s "$folder" "$folder.2"
    be_experiment "$folder" &
    WISPLAB_HOST=$other experiment "$folder.2" || fail "$folder: $(cat "$folder.2.err")"
    wait $! || fail "$folder: $(cat "$folder.err")"
    compare "$folder" "$folder"
    new=$(sed -n 's/.* runs, \([0-9]*\) of them new$/\1/p' "$folder.out" "$folder.2.out" |
        awk '{ sum += $1 } END { print sum + 0 }')
    [ "$new" = "$(ls quiet/runs | wc -l)" ] || fail "$folder: $new runs were done"
    echo "$folder: $new runs, each once"
}
together two-processes ""
together two-hosts elsewhere

# The other host is killed while it holds locks: nobody here can ask it, and it is taken for gone
# when it has not touched them for half a minute.
if [ -z "$short" ]; then
    mkdir gone
    WISPLAB_HOST=elsewhere be_experiment gone &
    until [ -n "$(find gone -name .lock)" ]; do pause 5; done
    kill -9 $!
    wait $! 2>/dev/null
    locks=$(find gone -name .lock | wc -l) begin=$(now)
    finish gone "a host that is gone"
    echo "a host that is gone: $locks locks, waited for $((($(now) - begin) / 1000)) s"
fi

# --- a full disk ---
# A small file system of its own where that can be had, and a limit of files' sizes everywhere.
full() {
    local folder=$1
    experiment "$folder"
    [ $? = 2 ] && [ "$(wc -l <"$folder.err")" = 1 ] || fail "a full disk: $(cat "$folder.err")"
    echo "a full disk: $(cat "$folder.err")"
}
mkdir disk
if mount -t tmpfs -o size=1m wisplab-torture disk 2>/dev/null; then
    mounted=disk
    mkdir disk/full
    full disk/full
    mount -o remount,size=100m disk
    finish disk/full "a full disk"
fi
mkdir files
(ulimit -f 8 && full files && exit "$failures") || failures=$((failures + 1))
finish files "small files"

# --- small limits ---
# However it ends, what is there is whole: files that may be open, memory, CPU time, processes.
limits=("-n 8" "-n 12" "-v 60000" "-v 200000" "-t 1" "-u 1" "-s 256")
[ -z "$short" ] || limits=("-n 8")
for limit in "${limits[@]}"; do
    mkdir limits
    (ulimit $limit && experiment limits) 2>/dev/null
    echo "ulimit $limit: exit code $?: $(head -n 1 limits.err)"
    finish limits "ulimit $limit"
    rm -rf limits
done

[ "$failures" = 0 ] && echo "torture.sh: all is there"
exit $((failures > 0))
