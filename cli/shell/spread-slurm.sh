#!/bin/sh
# job.sh -- runs an experiment in shards, the tasks of an array of Slurm's.
#
# ars-magna has written this and does not read it again: change what you like. Start it with
#     sh job.sh
# from anywhere, as often as you like. It submits itself, as an array of the shards that lack rows,
# waits for its end, and puts the tables of all shards together in rows.csv beside it. The output
# of tasks is in slurm.log. All nodes must see this directory.
#
#SBATCH --output=slurm.log
#SBATCH --open-mode=append
#SBATCH --ntasks=1

@SETTINGS@

set -u

say() { printf 'job.sh: %s\n' "$*" >&2; }

program() {  # OPTION...: this experiment.
    ./ars-magna experiment "$experiment" --trials "$trials" --out . "$@"
}

# One task of the array, where Slurm has put it.
if [ -n "${SLURM_ARRAY_TASK_ID:-}" ]; then
    program --shard "$SLURM_ARRAY_TASK_ID/$shards" --workers "$workers" $limit --quiet && exit
    say "task $SLURM_ARRAY_TASK_ID of job $SLURM_ARRAY_JOB_ID failed on $(hostname)"
    exit 1
fi

cd -- "$(dirname -- "$0")" || exit 1

# Ending this script cancels the job.
cancel() {
    trap '' INT TERM HUP
    kill -s TERM "$child" 2>/dev/null
    [ -s job.number ] && scancel "$(cut -d ';' -f 1 job.number)"
    exit 130
}

submit() {  # SHARD,...
    # Words, on purpose.
    sbatch --wait --parsable --job-name="$experiment" --cpus-per-task="$workers" --array="$1" \
        $options job.sh >job.number &
    child=$!
    trap cancel INT TERM HUP
    wait "$child"
    trap - INT TERM HUP
    rm -f job.number
}

left=$(program --shards "$shards" --missing) || exit 1
if [ -n "$left" ]; then
    command -v sbatch >/dev/null || { say "there is no Slurm here: sbatch is missing"; exit 1; }
    submit "$(printf '%s' "$left" | tr ' ' ',')"
fi
# Merging opens all tables at once.
ulimit -S -n "$(ulimit -H -n)" 2>/dev/null || :
./ars-magna merge . --out . $plot
merged=$?

left=$(program --shards "$shards" --missing) || exit 1
[ -z "$left" ] && exit $merged
say "these tasks lack rows: $left. slurm.log says why; start this again to continue."
exit 1
