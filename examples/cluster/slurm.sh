#!/bin/bash
# A campaign as a Slurm array job: each task flies one share, on one core, into a folder of its own.
#
#     sbatch --array=1-1000 slurm.sh CAMPAIGN FLIGHTS RESULTS
#
# CAMPAIGN is a built-in name or a TOML file, RESULTS a folder that all nodes see. A task that is requeued goes on where it was.
#SBATCH --job-name=alula
#SBATCH --cpus-per-task=1
#SBATCH --mem=200M
#SBATCH --time=02:00:00
#SBATCH --requeue
#SBATCH --output=%x-%A-%a.log
set -euo pipefail

exec "${ALULA_SIL:-alula-sil}" campaign "$1" --flights "$2" --threads 1 \
    --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT" \
    --out "$(printf '%s/shard=%04d' "$3" "$SLURM_ARRAY_TASK_ID")"
