# info --slice draws the cells that a plane cuts: whole, valid, told what it shows, or not at all.
source "$(dirname "$0")/support.sh" "$@"

# draw NAME ARGUMENT...: info with these arguments, and the drawing in the file NAME
draw() {
    local name=$1
    shift
    rm -f "$name"
    run info -q "$@" -o "$name"
    holds "$* draws" exits 0
    holds "$* says nothing on stderr" empty err
    holds "$* makes one SVG document" is "$(head -c 5 "$name") $(tail -n 1 "$name")" "<svg  </svg>"
    if command -v xmllint >/dev/null; then
        holds "$* makes valid XML" xmllint --noout "$name"
    fi
}

for axis in x y z; do
    for plan in split=binned split=space "split=object axis=robin"; do
        draw cut.svg "$scene" --slice $axis=50% --plan "$plan"
        for word in $plan; do
            holds "the legend tells $word" grep -qE "^<text.*\b$word " cut.svg
        done
        holds "it tells where the plane is" grep -qE "^<text.*cut at $axis = .* \(50 % of the box\)" cut.svg
        holds "it counts leaves" grep -qE '^<text.*[0-9]+ leaves cut, [0-9]+ of them empty' cut.svg
        holds "it tells the cost of the tree" grep -qE '^<text.*tree: cost [0-9.]+, [0-9.]+ references a triangle' cut.svg
        holds "leaves are filled" grep -qE '^<path fill="#[0-9a-f]{6}" d="M' cut.svg
        holds "triangles are lines" grep -qE '^<path fill="none" stroke="#e03c1c".* d="M[0-9. -]+L' cut.svg
        holds "the drawing is small" test "$(wc -c <cut.svg)" -lt 400000
    done
done
draw empties.svg builtin:stadium:3000 --slice y=20% --plan split=space
holds "empty leaves are outlined" grep -qE '^<path fill="none" stroke="#[0-9a-f]{6}" d="M.*V' empties.svg
cp cut.svg first.svg
draw cut.svg "$scene" --slice z=50% --plan "split=object axis=robin"
holds "the same slice is the same drawing" cmp -s first.svg cut.svg
draw cut.svg builtin:sphere:1000 --slice x=0.25
holds "a coordinate is told" grep -q 'cut at x = 0.25 ' cut.svg
draw cut.svg builtin:sphere:1000 --slice=x=-0.25
draw cut.svg builtin:sphere:1000 --slice x=0%
draw cut.svg builtin:sphere:1000 --slice x=100%
holds "the text of info stays on stdout" grep -q '^tree$' out

# stdout carries the drawing and nothing else; JSON goes beside it.
run info "$scene" -q --slice z=50% --plan "split=object axis=robin" -o - --json cut.json
holds "- is stdout" cmp -s out first.svg
holds "JSON is written beside it" has_key cut.json tree
run info "$scene" -q --slice z=50% -o cut.svg --json -
holds "JSON on stdout leaves the drawing its file" is "$(tail -n 1 cut.svg) $(head -c 1 out)" "</svg> {"

# Names that XML would take for its own, and one that is no text
cat >tri.obj <<'OBJ'
v 0 0 0
v 1 0 0
v 0 1 1
f 1 2 3
OBJ
for name in '<a>&"b".obj' $'bad\xff\x01name.obj' 'größe ★.obj' "$(printf 'long%.0s' {1..50}).obj"; do
    cp tri.obj "$name"
    draw cut.svg "$name" --slice y=50%
done
draw cut.svg 'größe ★.obj' --slice y=50%
holds "names keep their letters" grep -q '<text.*größe ★.obj, 1 triangles' cut.svg

# A flat mesh, cut across and in its own plane
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >flat.obj
for slice in x=50% y=0.5 z=0 z=50%; do
    draw cut.svg flat.obj --slice $slice
done

# Wrong usage
refuses() {
    local sentence=$1
    shift
    run info "$scene" "$@"
    holds "$* exits with 2 and says: $sentence" exits 2 "^kdray info: $sentence"
    holds "$* prints nothing" empty out
    holds "$* leaves no file" no test -e x.svg
}
for value in '' z 5 =5 w=5 z= z=% z=5%% z=-1% z=101% z=nan z=inf z=1e999 'z= 5' Z=5 xy=5 z=5x; do
    refuses '--slice: expected AXIS=POSITION, such as x=2.5, or z=50% .*, found "' --slice "$value" -o x.svg
done
refuses '--slice: expected -o FILE as well' --slice z=50%
refuses '-o: expected --slice AXIS=POSITION as well' -o x.svg
refuses '-o and --json: expected two files, found "x.svg" twice' --slice z=50% -o x.svg --json x.svg
refuses '-o and --json: expected two files, found "-" twice' --slice z=50% -o - --json -

# What cannot be done
fails() {
    local sentence=$1
    shift
    run info "$@"
    holds "$* exits with 1 and says: $sentence" exits 1 "^kdray info: $sentence"
    holds "$* says one sentence" is "$(wc -l <err)" 1
    holds "$* prints nothing" empty out
    holds "$* leaves no file" no test -e x.svg
}
fails '--slice: the box reaches from 0 to 1 on the axis x, and 1.5 lies outside' tri.obj --slice x=1.5 -o x.svg
printf 'v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n' >none.obj
fails 'there are no triangles, and so no cells to draw' none.obj -q --slice x=50% -o x.svg
fails 'the drawing would replace the mesh file tri.obj' tri.obj --slice x=50% -o tri.obj
fails 'none/x.svg cannot be written: No such file' tri.obj --slice x=50% -o none/x.svg
fails '/dev/full cannot be written: No space left' "$scene" -q --slice x=50% -o /dev/full

# Whole or not at all: a disk with no room keeps an older file as it was.
mkdir room
echo older >room/x.svg
(
    ulimit -f 1
    "$kdray" info "$scene" -q --slice z=50% -o room/x.svg >out 2>err.limited
    echo $? >status.limited
)
status=$(cat status.limited)
cp err.limited err
holds "a drawing without room exits with 1" exits 1 'room/x.svg.*File too large'
holds "the older file is still there, and nothing else" is "$(ls -A room) $(cat room/x.svg)" "x.svg older"
finish
