#!/bin/bash
# experiments/slurm.sh on a real Slurm: one node, set up for this and taken down again. Three tasks
# of an array share a sweep; in the middle one is cancelled and one is requeued. The table must be
# that of a sweep that nobody disturbs, but for its times, and no run be done twice that was through.
#
#   tests/slurm.sh [PROGRAM]      PROGRAM is build/wisplab where nothing else is said
#
# Needs root and Debian's slurmd, slurmctld and munge; says "skipped" and exits with 77 without.
set -euo pipefail
export LC_ALL=C
here=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
WISPLAB=$(realpath "${1:-$here/build/wisplab}")
export WISPLAB

skip() { echo "slurm.sh: skipped: $1" && exit 77; }
say() { echo "slurm.sh: $1"; }
[ "$(id -u)" = 0 ] || skip "not root, who alone may start jobs"
for need in slurmd slurmctld munged sbatch; do
    command -v $need >/dev/null || skip "no $need; apt-get install slurmd slurmctld munge"
done

work=$(mktemp -d "${TMPDIR:-/tmp}/wisplab-slurm-XXXXXX")
chmod 755 "$work" # munged looks whether others could write there
daemons=()
finish() {
    status=$?
    [ $status = 0 ] || tail -n 5 "$work"/*.log "$work"/task-* 2>/dev/null || true
    scancel --user=root 2>/dev/null && sleep 3
    [ ${#daemons[@]} = 0 ] || kill "${daemons[@]}" 2>/dev/null || true
    wait
    rm -rf "$work"
    exit $status
}
trap finish EXIT
give_up() { say "$1" >&2 && exit 1; }

# Until a command succeeds, or 120 s are over.
await() {
    for _ in $(seq 1200); do
        ! "$@" >/dev/null 2>&1 || return 0
        sleep 0.1
    done
    give_up "waited for nothing: $*"
}

# --- one node ---

node=$(hostname -s)
port=$((20000 + RANDOM % 20000))
mkdir "$work/state" "$work/spool"
head -c 1024 /dev/urandom >"$work/munge.key"
chmod 400 "$work/munge.key"
# Four processors, whatever there are. A requeued task would wait until its old credential is out of
# date, which takes two minutes where nothing else is said.
cat >"$work/slurm.conf" <<CONF
ClusterName=wisplab
SlurmctldHost=$node(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
SlurmUser=root
SlurmdUser=root
AuthInfo=socket=$work/munge.socket,cred_expire=5
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
MpiDefault=none
ReturnToService=2
KillWait=2
NodeName=$node NodeAddr=127.0.0.1 CPUs=4 State=UNKNOWN
PartitionName=all Nodes=$node Default=YES State=UP
CONF
export SLURM_CONF=$work/slurm.conf
export WISPLAB_HOST=slurm-$$ # timed runs of others are of no concern

start() {
    "$@" >>"$work/$1.log" 2>&1 &
    daemons+=($!)
}
start munged --foreground --force --socket="$work/munge.socket" --key-file="$work/munge.key" \
    --pid-file="$work/munge.pid" --seed-file="$work/munge.seed" --log-file="$work/munge.log"
await test -S "$work/munge.socket"
start slurmctld -D -c
start slurmd -D -N "$node"
is_idle() { sinfo --noheader --format=%T | grep -qx idle; }
await is_idle
say "$(sinfo --version) on one node"

# --- a sweep that nobody disturbs, and one that is an array ---

sweep=(sweep swing --duration 20 --vary rate=9000..12000:20 --vary 'wisps.[0].nodes=8,9,10,11,12,13')
runs=120
"$WISPLAB" "${sweep[@]}" --out "$work/alone" --no-progress >"$work/alone.log"

# What is not # and no time.
but_times() {
    awk -F'\t' -v OFS='\t' '
        /^#/ { print; next }
        !column { for (i = 1; i <= NF; i++) if ($i == "cpu_seconds") column = i }
        { $column = ""; print }' "$1/table.tsv"
}
results() { cat "$work"/array/runs/packed-* 2>/dev/null | wc -l; }
has() { [ "$(results)" -ge "$1" ]; }

array=$(sbatch --parsable --array=1-3 --cpus-per-task=1 --output="$work/task-%a.log" --open-mode=append \
    --chdir="$work" "$here/experiments/slurm.sh" "${sweep[@]}" --out "$work/array")
await has $((runs / 4))
scancel "${array}_3"
say "task 3 cancelled after $(results) of $runs runs"
await has $((runs / 3))
scontrol requeue "${array}_2"
say "task 2 requeued after $(results) of $runs runs"
state() { scontrol --oneliner show job "${array}_$1" | grep -o "$2"; }
is_over() { [ -z "$(squeue --noheader --jobs="$array" 2>/dev/null)" ]; }
await state 2 'Restarts=1'
await is_over
for task in 1 2; do
    state $task JobState=COMPLETED >/dev/null || give_up "task $task: $(scontrol show job "${array}_$task")"
done
state 3 JobState=CANCELLED >/dev/null || give_up "task 3 was not cancelled"
grep -h "of them new" "$work"/task-*.log | sed 's/;.*//; s/^/slurm.sh: /'
say "requeued: $(state 2 'Restarts=[0-9]*'), results: $(results) of $runs runs"

[ "$(results)" = $runs ] || give_up "a run was done twice, or not at all"
diff <(but_times "$work/alone") <(but_times "$work/array") || give_up "the tables differ"
[ -z "$(find "$work/array" -name '.claim*')" ] || give_up "a claim is left"
say "the table is that of a sweep that nobody disturbed, but for its times"
