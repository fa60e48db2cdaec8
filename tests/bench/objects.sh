#!/usr/bin/env bash
# The table of the experiments with objects is whole, and every way of showing them hits the same.
# Usage: objects.sh PROGRAM
set -uo pipefail
program=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0

# holds SENTENCE COMMAND...: the command must succeed.
holds() {
    local sentence=$1
    shift
    if ! "$@"; then
        failures=$((failures + 1))
        printf 'FAILED: %s\n' "$sentence"
    fi
}
is() { [[ $1 == "$2" ]]; }

# rows AWK: the table's rows, without notes and the line of names, go through the program. Names of ways have a comma.
rows() { grep -v '^#' "$work/table" | tail -n +2 | sed 's/"instances, /"instances /' | awk -F, "$1"; }

refused() {
    "$program" "$@" >"$work/out" 2>"$work/err"
    is $? 2 && [[ ! -s $work/out && -s $work/err ]]
}

"$program" --triangles 10000 --rounds 1 --side 64 >"$work/table" 2>"$work/log"
holds "the experiments run to their end" is $? 0
holds "columns are named" is "$(grep -v '^#' "$work/table" | head -1)" \
    objects,layout,way,triangles,rounds,commit_ms,primary_ms,shadow_ms,frame_ms,hits
holds "there are seven numbers of objects, two layouts, three ways" is "$(rows '{ print $1 $2 $3 }' | sort -u | wc -l)" 42
holds "every row has ten columns" is "$(rows 'NF != 10')" ''
holds "times are positive" is "$(rows '!($6 > 0 && $7 > 0 && $8 > 0 && $9 > 0)')" ''
holds "there are hits" is "$(rows '!($10 > 100)')" ''

# Instances turn rays instead of triangles, so that a few at the border may differ by rounding.
holds "all ways hit the same" is "$(rows '{
    key = $1 $2
    if (key in hits && ($10 - hits[key]) ^ 2 > 9) print key
    hits[key] = $10 }')" ''

holds "an unknown option is refused" refused --size 3
holds "a size out of range is refused" refused --triangles 99
holds "a side that is no multiple of 64 is refused" refused --side 100
holds "a count that is none is refused" refused --rounds many
holds "an option without its value is refused" refused --rounds
exit $((failures > 0))
