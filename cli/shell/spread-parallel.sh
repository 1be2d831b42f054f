#!/bin/sh
# run.sh -- runs an experiment in shards by GNU parallel, on this machine or on others by ssh.
#
# ars-magna has written this and does not read it again: change what you like. Start it with
#     sh run.sh
# from anywhere, as often as you like. It runs the shards that lack rows, and puts the tables of
# all shards together in rows.csv beside it. jobs.log says when each ran, where, and with what
# status. (GNU parallel asks to be cited in what is published: O. Tange, GNU Parallel 2018.)

@SETTINGS@

set -u
cd -- "$(dirname -- "$0")" || exit 1
PARALLEL_SHELL=/bin/sh
export PARALLEL_SHELL

say() { printf 'run.sh: %s\n' "$*" >&2; }

program() {  # OPTION...: this experiment.
    ./ars-magna experiment "$experiment" --trials "$trials" --out . "$@"
}

need() {  # COMMAND...
    for command; do
        command -v "$command" >/dev/null && continue
        say "$command is missing: sudo apt-get install parallel rsync openssh-client"
        exit 1
    done
}

# Ending this script also ends what it runs. A process that is just starting ignores signals.
stop() {
    trap '' INT TERM HUP
    while kill -s TERM "$child"; do sleep 0.3; done 2>/dev/null
    exit 130
}

heeding() {  # COMMAND...
    $tied "$@" &
    child=$!
    trap stop INT TERM HUP
    wait "$child"
    ended=$?
    trap - INT TERM HUP
    return $ended
}

# If the system can, it also ends what this runs when this is killed.
tied='setpriv --pdeathsig TERM'
$tied true 2>/dev/null || tied=

here() {  # SHARD...
    # The shell becomes the job, so that no other process is between this and the job.
    heeding parallel --will-cite $bar --quote --jobs "$jobs" --joblog jobs.log \
        exec $tied ./ars-magna experiment "$experiment" --trials "$trials" --out . \
        --shard "{}/$shards" --workers 1 $limit --quiet ::: "$@"
}

# Each machine gets the program, in a directory in the user's home that is removed at the end. It
# needs only rsync and perl.
there() {  # SHARD...
    need ssh rsync
    parallel --will-cite --nonall --sshlogin "$hosts" true </dev/null || {
        say "not all of $hosts can be reached"
        return
    }
    heeding parallel --will-cite $bar --quote --jobs "$jobs" --joblog jobs.log \
        --sshlogin "$hosts" --workdir "$place" --basefile ars-magna \
        --return "shard-{}-of-$shards" --cleanup \
        ./ars-magna experiment "$experiment" --trials "$trials" --out . \
        --shard "{}/$shards" --workers 1 $limit --quiet ::: "$@" &&
        parallel --will-cite --nonall --sshlogin "$hosts" rm -rf "$place"
}

left=$(program --shards "$shards" --missing) || exit 1
if [ -n "$left" ]; then
    need parallel
    if [ -t 2 ]; then bar=--bar; else bar=; fi
    # Words, on purpose.
    if [ -n "$hosts" ]; then there $left; else here $left; fi
fi
# Merging opens all tables at once.
ulimit -S -n "$(ulimit -H -n)" 2>/dev/null || :
heeding ./ars-magna merge . --out . $plot
merged=$?

left=$(program --shards "$shards" --missing) || exit 1
[ -z "$left" ] && exit $merged
say "these shards lack rows: $left. jobs.log has their status; start this again to continue."
exit 1
