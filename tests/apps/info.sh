# info prints what the mesh and its tree are made of, for people and as JSON.
source "$(dirname "$0")/support.sh" "$@"

# A mesh with two of everything: a NaN vertex, a triangle without area, and a material's name that is no UTF-8
cat >odd.obj <<'OBJ'
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
v nan 0 0
f 1 2 3
f 1 2 4
f 1 1 2
f 1 2 5
OBJ
run info odd.obj
holds "a mesh with odd triangles is read" exits 0 'warning'
holds "dropped triangles are counted" grep -qE '^  dropped +1 ' out
holds "triangles without area are counted" grep -qE '^  degenerate +1$' out
holds "the format is named" grep -qE '^  format +OBJ' out
holds "bounds are those of the finite vertices" grep -qE '^  bounds +0 0 0 to 1 1 1$' out
for word in vertices triangles materials load nodes leaves depth cost duplication bytes build; do
    holds "info prints $word" grep -qE "^  $word +[0-9]" out
done
holds "leaves are shown by depth" grep -q '^leaves by depth$' out
holds "leaves are shown by triangles" grep -q '^leaves by number of triangles$' out
run info odd.obj --quiet
holds "--quiet leaves the warning out" empty err

run info odd.obj -q --json odd.json
holds "JSON is written beside the text" grep -q '^mesh$' out
holds "JSON counts triangles" is "$(json odd.json triangles)" 3
holds "JSON counts dropped ones" is "$(json odd.json dropped)" 1
holds "JSON counts those without area" is "$(json odd.json degenerate)" 1
holds "JSON has the bounds" is "$(json odd.json bounds 5)" 1
for key in file format vertices dropped_vertices materials threads isa load_ms build_ms; do
    holds "JSON has $key" has_key odd.json $key
done
run info builtin:city:3000 --json - -t 2 --isa scalar
holds "--json - prints JSON alone" is "$(json out threads)" 2
holds "--isa reaches the device" is "$(json out isa)" scalar
leaves=$(json out tree leaves)
sum=0
for ((i = 0; i < $(grep -o 'depth_histogram.*' out | tr -cd , | wc -c); i++)); do
    value=$(json out tree depth_histogram $i 2>/dev/null) || break
    sum=$((sum + value))
done
holds "the histogram of depths counts every leaf" is "$sum" "$leaves"
cp out city.json
run info builtin:city:3000 --json - --depth-limit 2
holds "--depth-limit reaches the build" test "$(json out tree depth)" -le 2
for options in "--leaf-limit 2" "--traversal-cost 99" "--intersection-cost 99" "--reference-limit 1"; do
    # shellcheck disable=SC2086
    run info builtin:city:3000 --json - $options
    holds "$options reaches the build" differs "$(json out tree cost)" "$(json city.json tree cost)"
done

# An empty mesh is no reason to fail: figures that have no value are null.
printf 'ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\n' >empty.ply
printf 'element face 0\nproperty list uchar int vertex_indices\nend_header\n' >>empty.ply
run info empty.ply --json -
holds "a mesh without triangles is read" exits 0
holds "its JSON is JSON" is "$(json out triangles)" 0
run info empty.ply
holds "its bounds are none" grep -qE '^  bounds +none$' out

# The list of scenes, each of which can be made
run info --scenes
holds "the scenes are listed" test "$(wc -l <out)" -ge 5
cut -d' ' -f1 out >scenes
while read -r name; do
    run info "builtin:$name:200" -q --json -
    holds "builtin:$name can be made" has_key out tree
done <scenes
run info builtin:wave:500:0.25 -q --json still.json
holds "a moment of a moving scene can be had" exits 0
finish
