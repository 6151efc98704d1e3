#!/usr/bin/env bash
# Runs the kernel tests and a hash of a whole run under other ways to run a work-group, other work-group sizes and other numbers of threads: what does
# not rely on the order or the width of a processor gives the same bits everywhere.
#
#     bench/pocl_variants.sh [BUILD] [--csv FILE]
set -uo pipefail
cd "$(dirname "$0")/.."
build=build csv=""
while [ $# -gt 0 ]; do
    case "$1" in
        --csv) csv=$2; shift 2 ;;
        *) build=$1; shift ;;
    esac
done
tests="$build/tests/seldinger_tests"
[ -x "$tests" ] || { echo "pocl_variants.sh: no $tests; build it first" >&2; exit 1; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
table="variant,twin_tests,state_hash"
failed=0
first=""
variant() {  # name, then VAR=value ...
    local name=$1; shift
    local cache="$scratch/cache-${name//[^a-z0-9]/-}" twins=passed hash
    mkdir -p "$cache"
    env "$@" POCL_CACHE_DIR="$cache" timeout 900 "$tests" --no-intro --minimal --source-file='*test_twin*' >"$scratch/log" 2>&1 || twins=failed
    hash=$(env "$@" POCL_CACHE_DIR="$cache" timeout 300 "$tests" --no-skip --test-case='helper: print the state hash of a heavy run' 2>/dev/null |
        sed -n 's/.*state hash \([0-9a-f]\{16\}\).*/\1/p')
    [ -n "$first" ] || first=$hash
    [ "$twins" = passed ] && [ -n "$hash" ] && [ "$hash" = "$first" ] || failed=1
    table+=$'\n'"$name,$twins,${hash:-none}"
    echo "$name: twin tests $twins, state hash ${hash:-none}"
}
variant default
variant "work-group loops" POCL_WORK_GROUP_METHOD=loops
variant "work-group loopvec" POCL_WORK_GROUP_METHOD=loopvec
variant "work-group repl" POCL_WORK_GROUP_METHOD=repl
variant "work-group cbs" POCL_WORK_GROUP_METHOD=cbs
variant "work-groups of 1" SEL_WORKGROUP=1
variant "work-groups of 16" SEL_WORKGROUP=16
variant "work-groups of 256" SEL_WORKGROUP=256
variant "1 thread" POCL_MAX_PTHREAD_COUNT=1
variant "3 threads" POCL_MAX_PTHREAD_COUNT=3
[ -z "$csv" ] || printf '%s\n' "$table" >"$csv"
exit $failed
