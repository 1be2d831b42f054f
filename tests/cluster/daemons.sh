# daemons.sh -- what tests/cluster/run needs: packages, an ssh server, a Slurm of one node.
#
# To be sourced with $root and $work set when the functions are called. No systemd is needed.

node=  # The home on the other machine.

install_missing() {
    missing=
    for pair in sbatch:slurm-wlm parallel:parallel rsync:rsync \
                sshd:openssh-server ssh:openssh-client unshare:util-linux; do
        command -v "${pair%%:*}" >/dev/null || PATH=$PATH:/usr/sbin command -v "${pair%%:*}" \
            >/dev/null || missing="$missing ${pair#*:}"
    done
    [ -z "$missing" ] && return
    echo "Installing$missing (with apt-get)."
    { DEBIAN_FRONTEND=noninteractive apt-get -y install --no-install-recommends $missing ||
        { apt-get update &&
            DEBIAN_FRONTEND=noninteractive apt-get -y install --no-install-recommends $missing; }
    } >>"$work/log" 2>&1 </dev/null || {
        echo "Install by hand what is missing: sudo apt-get install$missing"
        exit 1
    }
}

end_by_file() {  # FILE...: end the daemons whose numbers are in them.
    for pid_file; do
        [ -s "$pid_file" ] && kill "$(cat "$pid_file")" 2>/dev/null
    done
}

end_daemons() {
    end_by_file "$work/slurm/slurmd.pid" "$work/slurm/slurmctld.pid" "$work/ssh/pid"
    [ -z "$node" ] || rm -rf "$node"
}

# The other machine. It is this one, seen through an ssh server of its own: in a name space where
# SBCL, the project, its cache and the results are hidden, with another home and nothing in the
# environment.

free_port() {
    perl -MIO::Socket::INET -e 'print IO::Socket::INET->new(Listen => 1, LocalAddr => "127.0.0.1")
        ->sockport'
}

start_remote() {
    ssh=$work/ssh port=$(free_port)
    node=$(mktemp -d /tmp/ars-magna-node.XXXXXX) || return
    mkdir -p "$ssh" /run/sshd
    ssh-keygen -q -t ed25519 -N '' -f "$ssh/host" && ssh-keygen -q -t ed25519 -N '' -f "$ssh/user"
    cat >"$ssh/enter" <<END
#!/bin/sh
exec unshare --mount sh -c '
    mount -t tmpfs none "$work"
    for hidden in "$root" "$HOME/.cache" /usr/lib/sbcl /usr/share/common-lisp; do
        [ ! -d "\$hidden" ] || mount -t tmpfs none "\$hidden"
    done
    [ ! -e /usr/bin/sbcl ] || mount --bind /dev/null /usr/bin/sbcl
    cd "$node" && exec env -i HOME="$node" PATH=/usr/bin:/bin SHELL=/bin/sh \\
        sh -c "\$0"' "\$SSH_ORIGINAL_COMMAND"
END
    chmod +x "$ssh/enter"
    cat >"$ssh/server" <<END
Port $port
ListenAddress 127.0.0.1
HostKey $ssh/host
AuthorizedKeysFile $ssh/user.pub
PidFile $ssh/pid
PermitRootLogin yes
StrictModes no
UsePAM no
MaxStartups 100
ForceCommand $ssh/enter
END
    cat >"$ssh/config" <<END
Host node
  HostName 127.0.0.1
  Port $port
  User $(id -un)
  IdentityFile $ssh/user
  UserKnownHostsFile $ssh/known
  StrictHostKeyChecking no
  LogLevel ERROR
END
    /usr/sbin/sshd -f "$ssh/server" >>"$work/log" 2>&1 && remotely true
}

remotely() {  # TEXT: let a shell do it on the other machine.
    ssh -F "$work/ssh/config" node "$1" >>"$work/log" 2>&1
}

# Slurm.

slurm_settings() {
    cat <<END
ClusterName=ars-magna
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$(free_port)
SlurmdPort=$(free_port)
AuthType=auth/none
CredType=cred/none
MpiDefault=none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
SlurmUser=root
StateSaveLocation=$slurm/state
SlurmdSpoolDir=$slurm/spool
SlurmctldPidFile=$slurm/slurmctld.pid
SlurmdPidFile=$slurm/slurmd.pid
SlurmctldLogFile=$slurm/slurmctld.log
SlurmdLogFile=$slurm/slurmd.log
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) RealMemory=1000
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
END
}

start_slurm() {
    slurm=$work/slurm host=$(hostname -s)
    mkdir -p "$slurm/state" "$slurm/spool"
    SLURM_CONF=$slurm/slurm.conf
    export SLURM_CONF
    slurm_settings >"$SLURM_CONF"
    { /usr/sbin/slurmctld -f "$SLURM_CONF" && /usr/sbin/slurmd -f "$SLURM_CONF"; } \
        >>"$work/log" 2>&1 || return
    tries=0
    until sinfo -h -o %T 2>/dev/null | grep -q idle; do
        tries=$((tries + 1))
        [ $tries -lt 30 ] || return
        sleep 1
    done
}

# Run by Slurm, and kill a task hard when there are many rows.
cut_short() {  # DIRECTORY
    program experiment "$file" --trials $trials --slurm --shards 2 --out "$1" &
    while kill -0 $! 2>/dev/null && [ "$(rows_in "$1")" -lt 2000 ]; do :; done
    for process in $(pgrep -f "^./ars-magna experiment $name .*--shard"); do
        [ "$(readlink "/proc/$process/cwd")" = "$1" ] && kill -s KILL "$process"
    done
    wait $!
    status=$? rows=$(rows_in "$1")
    [ $status -ne 0 ] && [ "$rows" -gt 1 ] && [ "$rows" -lt $((3 * trials)) ]
}
