#!/usr/bin/env bash
# A plan as an array of Slurm jobs that share a folder; a job whose node is lost is queued again and goes on.
#
#   sbatch --array=0-15 tools/recipes/slurm_array.sh PLAN.toml DIR 16
#   sbatch --dependency=afterany:JOB --wrap 'spool evaluate PLAN.toml --merge -o DIR'
#
# Shards that failed: the same first line with --array=3,7 in it. The number of shards is an argument, as it must not
# change with the array.
#SBATCH --job-name=spool
#SBATCH --requeue
set -euo pipefail
plan="$1" folder="$2" shards="$3"
exec "${SPOOL:-spool}" evaluate "$plan" --shard "$SLURM_ARRAY_TASK_ID/$shards" -o "$folder" --threads "${SLURM_CPUS_PER_TASK:-1}"
