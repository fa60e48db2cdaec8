# What the scripts share: a folder of their own, ways to run the program and to say what must hold.
# Sourced with the script's arguments: PROGRAM CMAKE.
set -uo pipefail
kdray=$1
cmake=$2
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
project=$(cd "$here/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
unset NO_COLOR KDR_ISA COLUMNS
statements=0
failures=0

# A scene of few triangles and a picture of few pixels: fast under sanitizers too.
scene=builtin:flake:2000
size=(-r 24x16)

# run ARGUMENT...: the program; its status is in $status, what it printed in the files out and err.
run() {
    "$kdray" "$@" >out 2>err </dev/null
    status=$?
}

# holds SENTENCE COMMAND...: the command must succeed.
holds() {
    local sentence=$1
    shift
    statements=$((statements + 1))
    if ! "$@"; then
        failures=$((failures + 1))
        printf 'FAILED: %s\n' "$sentence"
        printf '  status %s; stdout: %s; stderr: %s\n' "${status:-}" "$(head -c 600 out)" "$(head -c 600 err)"
    fi
}

# exits STATUS [PATTERN]: the last run did, and said one line that matches on stderr.
exits() {
    [[ $status == "$1" ]] && { [[ $# -lt 2 ]] || grep -qE -- "$2" err; }
}

is() { [[ $1 == "$2" ]]; }
differs() { [[ $1 != "$2" ]]; }
no() { ! "$@"; }
empty() { [[ ! -s $1 ]]; }
is_png() { [[ $(head -c 8 "$1" | od -An -tx1 | tr -d ' \n') == 89504e470d0a1a0a ]]; }

# png_size FILE: WIDTHxHEIGHT, from the header.
png_size() {
    local bytes
    read -ra bytes < <(od -An -tu1 -j16 -N8 "$1")
    echo "$(((bytes[0] << 24) + (bytes[1] << 16) + (bytes[2] << 8) + bytes[3]))x$(((bytes[4] << 24) + \
        (bytes[5] << 16) + (bytes[6] << 8) + bytes[7]))"
}

# json FILE KEY...: the value there; fails if FILE is not JSON or has no such key.
json() {
    "$cmake" "-DFILE=$1" "-DKEYS=$(IFS=';'; echo "${*:2}")" -P "$here/json_value.cmake" 2>&1
}
has_key() { json "$@" >/dev/null; }

# picture NAME ARGUMENT...: renders the scene to NAME.
picture() {
    local name=$1
    shift
    run render "$scene" "${size[@]}" --quiet -o "$name" "$@"
    holds "render $* makes a picture" exits 0
    holds "render $* writes a PNG file" is_png "$name"
}

finish() {
    ((statements > 0)) || { echo "nothing was stated"; exit 1; }
    echo "$statements statements, $failures failed"
    exit $((failures > 0))
}
