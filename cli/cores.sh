# cores.sh -- shared by ./cli/ars-magna and ./tests/run: saved cores. Source it after setup.sh.
#
# A core lies in $cache, with a list of what it was made from and a check sum beside it. There are
# three kinds: for the prompt, with McCLIM for --window, and for the tests. Before it is run,
# $runtime_options are the options of SBCL's runtime for it.

choose_core() {  # KIND SAVE [SOURCES [SYSTEM...]]: the kind of core, the function of build.lisp
    # that saves it, a directory of sources beside the program's, and systems beside the prompt's.
    kind=$1 save=$2 more_sources=${3:-}
    shift "$(($# < 3 ? $# : 3))"
    systems="ars-magna ars-magna/cli $*"
    core=$cache/$kind.core
}

# Does it exist, made from the present sources and libraries? Dates of sources do not count.
core_current() {
    [ -f "$core" ] && [ "$(cat "$core.sources" 2>/dev/null)" = "$(core_sources)" ] &&
        libraries_current "$core"
}

core_sources() { source_sums src rpl worlds cli $more_sources | cksum; }

# The SBCL runtime that a core was made with. `sbcl` may be a script that chooses another core.
runtime_of() { sed -n '1s/^file //p' "$1"; }  # LIST

run_core() {  # RUNTIME CORE ARGUMENT...
    runtime=$1 file=$2; shift 2
    "$runtime" --core "$file" $runtime_options "$@"
}

# Does it start? In a subshell, so that this shell can report meanwhile that it is stopped.
core_starts() (  # RUNTIME CORE LOG
    run_core "$1" "$2" --probe </dev/null >>"$3" 2>&1
)

core_whole() { [ "$(cat "$core.sum" 2>/dev/null)" = "$(cksum <"$core")" ]; }

# An undamaged core has started when it was made.
core_ready() {
    core_current && core_whole || return
    probe=$(run_core "$(runtime_of "$core.list")" "$core" --probe </dev/null 2>&1) ||
        give_up "SBCL cannot start $core, which is as it was made:" \
            "$(printf '%s\n' "$probe" | grep -a . | tail -n 1)." \
            "Is memory limited (see ulimit -v)? It takes 2 GB of addresses."
}

# The core itself comes last: an interrupted installation leaves no core.
install_core() {  # NEW-CORE, with files about it beside it.
    rm -rf "$core" "$core".*
    cksum <"$1" >"$core.sum" &&
        cp "$libraries.list" "$core.list" &&
        cp "$libraries.found" "$core.found" &&
        mv -f "$1.sources" "$core.sources" &&
        mv -f "$1" "$core"
}

build_core() {
    core_ready && return  # Another process has made it meanwhile.
    # Remains of processes that were killed.
    rm -rf "$cache"/new.*
    ARS_MAGNA_CORE=$cache/new.core
    export ARS_MAGNA_CORE
    # Sources that change from here on lead to another core.
    core_sources >"$ARS_MAGNA_CORE.sources" &&
        compile "$kind" "(ars-magna.build:$save)" &&
        core_starts "$(runtime_of "$libraries.list")" "$ARS_MAGNA_CORE" "$log" &&
        install_core "$ARS_MAGNA_CORE"
    built=$?
    unset ARS_MAGNA_CORE
    rm -rf "$cache"/new.*
    return $built
}

ensure_core() {  # TROUBLE: the message if it cannot be made.
    core_ready && return
    ensure_packages $systems
    if core_current; then
        say "the saved core is damaged; making it again"
    elif [ ! -s "$core.list" ]; then
        say "compiling, at the first start"
    elif [ ! -f "$core" ]; then
        say "the saved core is gone; compiling again"
    elif libraries_current "$core"; then
        say "sources have changed; compiling again"
    else
        say "SBCL or libraries have changed; compiling again"
    fi
    with_lock build_core || give_up "$1; see $cache/$kind.log"
}
