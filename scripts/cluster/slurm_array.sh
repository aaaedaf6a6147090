#!/usr/bin/env bash
# Dock the pairs of a table as an array of Slurm, one task per shard.
#
# usage: sbatch --array=1-SHARDS slurm_array.sh SHARDS PAIRS.csv DIR [options of knotdock dock]
#
# DIR is on a disk that all nodes share. A task that is ended by its time limit or its node goes on where it was when it
# is submitted again: `sbatch --array=3,17 slurm_array.sh 100 ...` for shards 3 and 17 of 100. When all are done,
# `knotdock merge DIR` writes DIR/results.csv and DIR/poses.csv.gz.
#SBATCH --job-name=knotdock
#SBATCH --cpus-per-task=1
#SBATCH --mem=2G
#SBATCH --time=12:00:00
#SBATCH --requeue
#SBATCH --open-mode=append
set -euo pipefail
if [ "$#" -lt 3 ]; then
    sed -n '4s/^# //p' "$0" >&2
    exit 2
fi
shards=$1 pairs=$2 directory=$3
shift 3
# With --scratch on a disk of the node the shared disk gets a shard's files at the end; what a killed task did is on its
# node alone then.
exec knotdock batch "$pairs" -o "$directory" --shard "$SLURM_ARRAY_TASK_ID/$shards" --keep table --failures-ok \
    -j "${SLURM_CPUS_PER_TASK:-1}" -- "$@"
