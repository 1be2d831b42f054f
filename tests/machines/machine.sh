# machine.sh -- makes a bare Debian and runs the project in it, for ./tests/machines/run.
#
#     unshare ... sh machine.sh SUITE MIRROR LOGS PROJECT.tar
#
# The Debian lies in LOGS/machine. The namespaces of mounts and processes are the script's own: what
# it mounts and starts ends with it. Prints one line, and ends with status 1 if something failed.

set -u
suite=$1 mirror=$2 logs=$3 project=$4
machine=$logs/machine
line=

finish() {  # STATUS: print the line and exit.
    version=$(chroot "$machine" sbcl --version 2>/dev/null)
    printf '%s%s: %s\n' "$suite" "${version:+ ($version)}" "$line"
    exit "$1"
}

# A failed test or an error of apt or debootstrap is the reason, or else the last line of a log.
reason() {  # LOG
    { grep -a -e '^FAILED ' -e '^E: ' -e '^W: Failure' "$1" || grep -a . "$1"; } |
        tail -n 1 | sed 's/^FAILED //'
}

keep_logs() {  # Keep those that lie in the machine.
    cp "$machine/debootstrap/debootstrap.log" "$logs/debootstrap-inside.log"
    for home in root 'a b'; do
        mkdir "$logs/$home" && cp "$machine/home/$home/.cache/ars-magna"/*/*.log "$logs/$home"
        rmdir "$logs/$home"
    done
}

fail() {  # WHAT LOG: end with what failed, the reason, and where the logs are.
    { grep -a -A 4 '^FAILED ' "$logs/$2.log" || tail -n 30 "$logs/$2.log"; } >&2
    keep_logs 2>/dev/null
    line="$line$1 FAILED: $(reason "$logs/$2.log"); logs in $logs"
    finish 1
}

# Making it.

bootstrap() {
    # Systems that mount /tmp without devices would be refused.
    mkdir "$machine" && mount --bind "$machine" "$machine" &&
        mount -o remount,bind,dev,exec,suid "$machine" || return
    script=/usr/share/debootstrap/scripts/$suite
    [ -e "$script" ] || script=${script%/*}/sid
    eval "$(apt-config shell proxy Acquire::http::Proxy)"
    http_proxy=${http_proxy:-${proxy:-}} LC_ALL=C TMPDIR=/tmp \
        debootstrap --variant=minbase "$suite" "$machine" "$mirror" "$script"
}

# Let apt in the machine reach the mirror as apt does here.
connect() {
    cp -L /etc/resolv.conf /etc/hosts "$machine/etc/"
    {
        apt-config dump | grep -e '^Acquire::https\?::' -e '^Acquire::Check-'
        [ -z "${http_proxy:-}" ] || echo "Acquire::http::Proxy \"$http_proxy\";"
        [ -z "${https_proxy:-}" ] || echo "Acquire::https::Proxy \"$https_proxy\";"
        case $mirror in https:*) trust_certificates ;; esac
    } >"$machine/etc/apt/apt.conf.d/99host"
}

trust_certificates() {
    certificates=/etc/ssl/certs/ca-certificates.crt
    eval "$(apt-config shell bundle Acquire::https::CAInfo)"
    mkdir -p "$machine${certificates%/*}" &&
        cp -L "${bundle:-$certificates}" "$machine$certificates" &&
        echo "Acquire::https::CAInfo \"$certificates\";"
}

mount_devices() {
    mount -t proc proc "$machine/proc" &&
        mount -t devpts -o newinstance,ptmxmode=666,mode=620,gid=5 devpts "$machine/dev/pts" &&
        ln -sf pts/ptmx "$machine/dev/ptmx" &&
        mount -t tmpfs -o nosuid,nodev,mode=1777 tmpfs "$machine/dev/shm"
}

forbid_services() {
    printf '#!/bin/sh\nexit 101\n' >"$machine/usr/sbin/policy-rc.d" &&
        chmod 755 "$machine/usr/sbin/policy-rc.d"
}

# The project lies in the homes of two users. One is root. The other may do nothing as root, and has
# blanks in all names.
place_project() {  # UID HOME DIRECTORY
    mkdir -p "$machine$2/$3" && tar -x -f "$project" -C "$machine$2/$3" &&
        chown -R "$1:$1" "$machine$2"
}

make_machine() {
    bootstrap && connect && mount_devices && forbid_services &&
        chroot "$machine" useradd -u 1000 -U -d '/home/a b' -s /bin/sh visitor &&
        place_project 0 /home/root ars-magna && place_project 1000 '/home/a b' 'ars magna'
}

# Running it.

inside() {  # UID HOME DIRECTORY LOG COMMAND: run it there; $seconds is how long it took.
    started=$(date +%s)
    env -i HOME="$2" PATH=/usr/sbin:/usr/bin:/sbin:/bin \
        chroot --userspec="$1:$1" --groups= "$machine" sh -c 'cd "$1" && eval "$2"' \
        sh "$2/$3" "$5" >"$logs/$4.log" 2>&1 </dev/null
    status=$?
    seconds=$(($(date +%s) - started))
    return $status
}

as_root() { inside 0 /home/root ars-magna "$@"; }
as_user() { inside 1000 '/home/a b' 'ars magna' "$@"; }

prompt='echo status | ./cli/ars-magna'
answered() { grep -q '^Position:' "$logs/$1.log"; }
counts() { grep -a -x '[0-9]* passed, [0-9]* failed.*' "$logs/$1.log" | tail -n 1; }

make_machine >"$logs/debootstrap.log" 2>&1 || fail "making it" debootstrap
! as_user missing "$prompt" && grep -q 'sudo apt-get install sbcl' "$logs/missing.log" ||
    fail "telling a user without root what to install" missing

as_root prompt "$prompt" && answered prompt || fail "prompt" prompt
line="prompt ok in $seconds s, "
as_root tests ./tests/run
passing=$?
counted=$(counts tests)
line="$line${counted:+$counted in $seconds s, }"
[ $passing -eq 0 ] || fail "tests" tests

without="as a user without root:"
as_user user-prompt "$prompt" && answered user-prompt || fail "$without prompt" user-prompt
as_user user-tests './tests/run geometry' || fail "$without tests" user-tests
line="$line$without ok"
finish 0
