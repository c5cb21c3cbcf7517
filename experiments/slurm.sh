#!/bin/bash
# An example of a job script: a sweep or an experiment by an array of tasks, on any number of nodes.
#
#   sbatch --array=1-16 experiments/slurm.sh sweep swing --vary rate=3000..30000:1000 --out swept
#   sbatch --array=1-4 experiments/slurm.sh experiment stability --out results
#
# Every task is the same command on the same folder, which all nodes must see; they share the runs,
# and each that is through has written the same tables. A task that is cancelled, requeued or lost
# with its node is at a few runs, which the others do; one that comes late finds less to do.
#SBATCH --job-name=wisplab
#SBATCH --cpus-per-task=2
#SBATCH --time=04:00:00
#SBATCH --requeue
set -eu
exec "${WISPLAB:-wisplab}" "$@" --jobs "${SLURM_CPUS_PER_TASK:-1}" --no-progress
