# setup.sh -- shared by ./cli/ars-magna and ./tests/run: installing and compiling what is needed.
#
# Source it with $root set to the project's directory. All files that it makes are in
# $cache, one directory for each checkout and version of SBCL: compiled files, logs, saved cores.

say() { printf 'ars-magna: %s\n' "$*" >&2; }

give_up() { say "$*"; exit 1; }

# Programs interpret a relative home directory differently.
case ${HOME:-/} in /*) ;; *) HOME=$PWD/$HOME ;; esac

# Signals. Ending a start also ends the processes that it has begun. The shell handles a signal only
# after its child has ended, unless it waits for a child in the background.

watching=

heeding() {  # COMMAND...: run it, and end it if this shell is ended meanwhile.
    watching=yes
    "$@" &
    wait $!
    ended=$?
    watching=
    return $ended
}

# A Lisp may hang in its exit handlers, so it is killed. Half-written files are removed later.
end_by() {  # SIGNAL: end the child and this shell, as by default for the signal.
    trap '' HUP INT TERM
    [ -z "$watching" ] || { kill -s KILL "$!" && wait "$!"; } 2>/dev/null
    [ -z "$watching" ] || [ ! -t 2 ] || printf '\r%75s\r' '' >&2  # A line of Lisp's on progress.
    [ "$1" != INT ] || say stopped.
    trap - "$1"
    kill -s "$1" $$
}

for signal in HUP INT TERM; do trap "end_by $signal" "$signal"; done

# Directories.

home_directory() {  # VARIABLE'S-VALUE DEFAULT: the value if it is an absolute path.
    case $1 in
        /*) printf '%s' "$1" ;;
        *)  printf '%s' "${HOME:-/}/$2" ;;
    esac
}

make_private() {  # DIRECTORY: true if it is there and ours to write.
    mkdir -p -m 700 "$1" 2>/dev/null && [ -O "$1" ] && [ -w "$1" ]
}

choose_cache() {
    # A user's script for SBCL may print more.
    version=$(sbcl --version 2>/dev/null | grep '^SBCL ' | tail -n 1 | tr -c 'A-Za-z0-9.\n' '-')
    own=$(printf '%s' "$root" | cksum | cut -d ' ' -f 1)/${version:-no-SBCL}
    cache=$(home_directory "${XDG_CACHE_HOME:-}" .cache)/ars-magna/$own
    make_private "$cache" || choose_temporary_cache "$cache"
    ARS_MAGNA_CACHE=$cache/
    export ARS_MAGNA_CACHE
}

choose_temporary_cache() {  # DIRECTORY: it cannot be written.
    base=${TMPDIR:-/tmp}/ars-magna-$(id -u)
    cache=$base/$own
    make_private "$base" && make_private "$cache" ||
        give_up "cannot write to a cache directory. Set XDG_CACHE_HOME to one."
    say "cannot write to $1; using $cache"
}

# What must be installed.

dependencies() {  # SYSTEM: what its definition names, one a line.
    sed -n "\\|(defsystem \"$1\"|,\\|:components|p" "$root/ars-magna.asd" | tr '\n' ' ' |
        sed -n 's|.*:depends-on (\([^)]*\)).*|\1|p' | tr -d '"' | tr -s ' ' '\n'
}

libraries() {  # SYSTEM: the libraries that it stands on, also through systems of ours, one a line.
    for dependency in $(dependencies "$1"); do
        case $dependency in
            ars-magna*) libraries "$dependency" ;;
            sb-* | *[!a-z0-9.-]*) ;;
            *) echo "$dependency" ;;
        esac
    done
}

plainly='--noinform --no-sysinit --no-userinit --non-interactive'

plain_sbcl() { heeding sbcl $plainly "$@" </dev/null; }

# build.lisp writes errors to the standard output, SBCL to the error output.
ask_lisp() {  # FORM: what this form of build.lisp prints.
    plain_sbcl --load "$root/cli/build.lisp" --eval "$1"
}

no_answer() {  # TEXT: give up, as Lisp has ended with an error and printed TEXT.
    give_up "${1:-SBCL does not run. Does sbcl --version, or sbcl alone?}"
}

missing_packages() {  # SYSTEM...: the Debian packages that it takes and that are not there.
    # Words, on purpose, here and below.
    wanted=$(echo $(for system; do libraries "$system"; done | sort -u))
    if command -v sbcl >/dev/null; then
        wanted=$(LIBRARIES=$wanted ask_lisp '(ars-magna.build:print-missing-libraries)') ||
            no_answer "$wanted"
        wanted=$(printf '%s\n' "$wanted" | sed -n 's/^missing: //p')
    else
        printf 'sbcl '
    fi
    for library in $wanted; do printf 'cl-%s ' "$library"; done
}

apt() { $as_root env DEBIAN_FRONTEND=noninteractive apt-get -y "$@" </dev/null; }

install_packages() {  # PACKAGE...
    by_hand="install by hand what is missing: sudo apt-get install $*"
    command -v apt-get >/dev/null || give_up "$by_hand"
    as_root=
    if [ "$(id -u)" -ne 0 ]; then
        sudo -n true 2>/dev/null || give_up "$by_hand"
        as_root='sudo -n'
    fi
    say "installing $* (with apt-get)"
    log=$cache/install.log
    apt install --no-install-recommends "$@" >"$log" 2>&1 ||
        { apt update >>"$log" 2>&1 && apt install --no-install-recommends "$@" >>"$log" 2>&1; } ||
        { cat "$log" >&2; give_up "$by_hand"; }
}

ensure_packages() {  # SYSTEM...
    packages=$(missing_packages "$@") || exit 1
    [ -n "$packages" ] || return 0
    install_packages $packages
    choose_cache
}

# Programs whose packages have the same names.
ensure_programs() {  # PROGRAM...: true if all of them are there, or can be installed.
    packages=$(for program; do command -v "$program" >/dev/null || printf '%s ' "$program"; done)
    [ -z "$packages" ] || (install_packages $packages)
}

# The SBCL and libraries from which something was made. build.lisp lists, in a file X.list, their
# files and the places and names by which ASDF finds libraries, one a line: `file PATH`,
# `tree DIRECTORY`, `directory DIRECTORY`, `name ENDING`. Asking ASDF at each start would take a
# second; comparing dates and sizes takes some hundredths. X.found has the last result. It changes
# when a library changes, when one of the same name appears in another place, which may be found
# first, and when ASDF is configured to look elsewhere.

library_state() (  # LIST: size, date and path of each of these files, one a line.
    # Paths may have spaces.
    IFS='
'
    set -f
    listed() { sed -n "s/^$1 //p" "$list"; }
    list=$1
    {
        listed file
        {
            find -L $(listed tree) -name .git -prune -o \
                 \( -name '*.asd' -o -name '*.conf' \) -print
            find -L $(listed directory) -maxdepth 1 -name '*.asd'
        } 2>/dev/null | grep -F -e "$(listed name)"
    } | LC_ALL=C sort -u | tr '\n' '\0' | xargs -0 stat -L -c '%s %Y %n' 2>/dev/null
    printf '%s\n' "${CL_SOURCE_REGISTRY:-}"
)

libraries_current() {  # X: are the libraries of X.list as they were?
    [ -s "$1.list" ] && [ "$(cat "$1.found" 2>/dev/null)" = "$(library_state "$1.list")" ]
}

# ASDF compares dates: a library that was installed in place of another may be older than the
# compiled files of that one.
forget_changed_libraries() {
    for list in "$cache"/libraries/*.list; do
        [ ! -e "$list" ] || libraries_current "${list%.list}" ||
            { rm -rf "$cache/libraries"; return; }
    done
}

# Compiling. Simultaneous starts wait for each other, where the system has flock. They also wait for
# a compiler that still runs after its start was killed.

with_lock() {  # COMMAND...
    command -v flock >/dev/null || { "$@"; return; }
    [ ! -d "$cache/lock" ] || rm -rf "$cache/lock"
    { true 9>"$cache/lock"; } 2>/dev/null || return
    exec 9>"$cache/lock"
    heeding flock 9 && "$@"
    locked=$?
    exec 9>&-
    return $locked
}

source_sums() {  # DIRECTORY...: a check sum of each source there, and its name.
    # Editors keep broken links beside files, with names such as .#file.lisp.
    ( cd "$root" && find ars-magna.asd "$@" ! -name '.*' \( -name '*.lisp' -o -name '*.asd' \
                -o -name 'usage*.txt' -o -name 'spread-*.sh' -o -name '*.js' -o -name '*.css' \) \
                -exec cksum {} + |
          LC_ALL=C sort -k 3 )
}

# The compiler compares dates. Compiled files of sources that have changed or are gone are removed.
# So a changed source with an old date is compiled again, and a missing one is noticed.
forget_changed() {
    known=$cache/sources
    source_sums src rpl worlds cli tests >"$known.new" || return
    [ -f "$known" ] || : >"$known"
    LC_ALL=C sort "$known.new" >"$known.left" && LC_ALL=C sort "$known" >"$known.right" &&
        LC_ALL=C comm -3 "$known.left" "$known.right" |
            while read -r _ _ file; do rm -f "$cache/project/${file%.*}.fasl"; done
    rm -f "$known.left" "$known.right"
    mv -f "$known.new" "$known"
}

# A compiler that was killed may leave half of a compiled file.
forget_halves() {
    find "$cache" \( -name '*-tmp*.fasl' -o -type d -name '*.fasl' \) -prune -exec rm -rf {} +
}

# Compiled files may be so damaged that Lisp crashes. Status 2 means that the sources are at fault.
compile_anew() {  # COMMAND...: do it, and once more without what was compiled before if that fails.
    before=$(ls -d "$cache/project" "$cache"/libraries/*/ 2>/dev/null)
    "$@" && return
    [ $? -ne 2 ] && [ -n "$before" ] && roomy || return
    say "compiled files are damaged; compiling again"
    rm -rf "$cache/project" "$cache/libraries"
    "$@"
}

roomy() {  # Is there room for another 10 MB?
    head -c 10000000 /dev/zero 2>/dev/null >"$cache/room"
    kept=$(wc -c <"$cache/room" 2>/dev/null)
    rm -f "$cache/room"
    [ "${kept:-0}" -eq 10000000 ]
}

# Only the child's output is redirected: this shell's messages go to the screen.
into() {  # FILE COMMAND...
    file=$1; shift
    exec "$@" >"$file"
}

# Lisp shows on the error output which file it compiles, and writes errors to the log.
evaluate_building() {  # LOG LISP-FORM
    heeding into "$1" sbcl $plainly --load "$root/cli/build.lisp" \
        --eval '(ars-magna.build:show-progress)' --eval "$2"
}

compile() {  # NAME LISP-FORM: evaluate the form of build.lisp; show its troubles if that fails.
    log=$cache/$1.log
    libraries=$cache/libraries/$1
    [ ! -d "$log" ] || rm -rf "$log"
    forget_halves
    forget_changed_libraries
    forget_changed || say "cannot check which sources have changed; is $cache full?"
    ARS_MAGNA_LIBRARIES=$libraries.list
    export ARS_MAGNA_LIBRARIES
    compile_anew evaluate_building "$log" "$2"
    compiled=$?
    unset ARS_MAGNA_LIBRARIES
    # Also after a failure, which does not make the compiled libraries out of date.
    [ ! -s "$libraries.list" ] || library_state "$libraries.list" >"$libraries.found"
    if [ $compiled -eq 0 ]; then
        # For example, that this SBCL is newer than those tested.
        grep -a '^ars-magna: ' "$log" >&2 || :
        return 0
    fi
    if roomy && ! grep -a -q -e 'No space left' -e 'quota exceeded' "$log"; then
        grep -a -v -e '^; compil' -e '^; wrote' -e '^$' "$log" | tail -n 60 >&2
        say "compiling failed; the whole output is in $log"
    else
        say "there is no room in $cache. Make some, or set XDG_CACHE_HOME to another directory."
    fi
    return 1
}
