#!/usr/bin/env bash
# A plan in shards by GNU parallel: as many at a time as there are cores, or what parallel is told.
#
#   tools/recipes/parallel.sh PLAN.toml DIR 16 [ARGUMENTS OF PARALLEL...]
#   tools/recipes/parallel.sh PLAN.toml DIR 16 --sshlogin host1,host2 --workdir .   (with a folder that all of them see)
#
# Again after an interruption: finished results are not made again.
set -euo pipefail
plan="$1" folder="$2" shards="$3"
shift 3
program="${SPOOL:-spool}"
seq 0 $((shards - 1)) |
  parallel --quote --retries 2 "$@" "$program" evaluate "$plan" --shard "{}/$shards" -o "$folder" --threads 1 -q || true
# Tells what is missing or failed, and says so with its exit code.
exec "$program" evaluate "$plan" --merge -o "$folder"
