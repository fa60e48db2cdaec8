#!/usr/bin/env bash
# The table of the build experiments has its shape, all its experiments, and one tree for what must not change a tree.
# Usage: experiments.sh PROGRAM
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

# rows AWK: the table's rows, without notes and the line of names, go through the program.
rows() { grep -v '^#' "$work/table" | tail -n +2 | awk -F, "$1"; }

# refused ARGUMENT...: the program says why it does not start, and measures nothing.
refused() {
    "$program" "$@" >"$work/out" 2>"$work/err"
    is $? 2 && [[ ! -s $work/out && -s $work/err ]]
}

unset KDRAY_SCENES
"$program" --triangles 400 --largest 2000 --rounds 2 >"$work/table" 2>"$work/log"
holds "the experiments run to their end" is $? 0
holds "the machine is named" grep -q '^# machine: ' "$work/table"
holds "columns are named" is "$(grep -v '^#' "$work/table" | head -1)" \
    experiment,plan,memory,scene,triangles,threads,rounds,seconds,spread,wall_seconds,n_log_n,cost,tree
holds "every row has thirteen columns" is "$(rows 'NF != 13')" ''
holds "counts are positive" is "$(rows '!($5 > 0 && $6 > 0 && $7 == 2)')" ''
holds "times and costs are positive" is "$(rows '!($8 > 0 && $9 >= 0 && $10 > 0 && $11 > 0 && $12 > 0)')" ''
holds "trees are told by sixteen digits" is "$(rows '$13 !~ /^[0-9a-f]+$/ || length($13) != 16')" ''
holds "every experiment is there" is "$(rows '{ print $1 }' | sort -u | xargs)" "events growth order pools shares"
holds "no row is there twice" is "$(rows '{ print $1, $2, $3, $4, $5, $6 }' | sort | uniq -d)" ''

# Order, memory and threads do not change a tree: its plan without the order, and the scene, tell which it is.
holds "plans that differ only in order, memory or threads make one tree" is "$(rows '{
    plan = $2
    sub(/ order=[a-z]*/, "", plan)
    key = plan " " $4 " " $5
    if (key in tree && tree[key] != $13) print key
    tree[key] = $13 }')" ''
holds "there are such plans" test "$(rows '$3 == "node"' | wc -l)" -ge 10
holds "both orders are there" is "$(rows 'match($2, /order=[a-z]*/) { print substr($2, RSTART, RLENGTH) }' | sort -u |
    xargs)" "order=bfs order=dfs"
holds "one and two threads are there" is "$(rows '{ print $6 }' | sort -u | xargs)" "1 2"

KDRAY_SCENES=$work "$program" --triangles 400 --rounds 1 --only order >"$work/out" 2>"$work/err"
holds "a folder without scenes is an error" is $? 1
printf '%s\n' ply 'format ascii 1.0' 'element vertex 3' 'property float x' 'property float y' 'property float z' \
    'element face 1' 'property list uchar int vertex_indices' end_header '0 0 0' '1 0 0' '0 1 0' '3 0 1 2' >"$work/one.ply"
KDRAY_SCENES=$work "$program" --triangles 400 --rounds 1 --only order >"$work/table" 2>"$work/err"
holds "files of a folder are measured" is $? 0
holds "they go by their names" is "$(rows '$4 == "one" { print $5 }' | sort -u)" 1
holds "only what is asked for is measured" is "$(rows '{ print $1 }' | sort -u)" order

holds "an unknown option is refused" refused --size 3
holds "an unknown experiment is refused" refused --only speed
holds "a size out of range is refused" refused --triangles 99
holds "a count that is none is refused" refused --rounds many
holds "an option without its value is refused" refused --rounds
exit $((failures > 0))
