# render --time shows a glTF file as it is at a moment of its animation.
source "$(dirname "$0")/support.sh" "$@"

# A triangle of size 1 that moves from the origin to x = 2 within a second: three corners, two times, two places.
floats() {
    local value
    for value in "$@"; do
        case $value in
            0) printf '\x00\x00\x00\x00' ;;
            1) printf '\x00\x00\x80\x3f' ;;
            2) printf '\x00\x00\x00\x40' ;;
        esac
    done
}
bytes=$(floats 0 0 0 1 0 0 0 1 0 0 1 0 0 0 2 0 0 | base64 -w 0)
cat >moves.gltf <<JSON
{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
 "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
 "animations": [{"channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
                 "samplers": [{"input": 1, "output": 2, "interpolation": "LINEAR"}]}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
               {"bufferView": 1, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1]},
               {"bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC3"}],
 "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 8},
                 {"buffer": 0, "byteOffset": 44, "byteLength": 24}],
 "buffers": [{"byteLength": 68, "uri": "data:application/octet-stream;base64,$bytes"}]}
JSON

# at NAME SECONDS [X]: a picture of the place x, 3 wide.
at() {
    run render moves.gltf -q -r 30x30 --camera "${3:-1},0.5,3" --target "${3:-1},0.5,0" -o "$1.png" --time "$2"
    holds "a picture is made at $2 s" exits 0
}
at begin 0
at half 0.5
at end 1
at later 7
holds "the triangle moves" no cmp -s begin.png end.png
holds "half way it is elsewhere than at the begin" no cmp -s begin.png half.png
holds "and than at the end" no cmp -s half.png end.png
holds "it stays when the animation is over" cmp -s end.png later.png
at moved 1 3
holds "it is as far from where it was as the file says" cmp -s moved.png begin.png
run render moves.gltf -q -r 30x30 --camera 1,0.5,3 --target 1,0.5,0 -o still.png
holds "without a time the file is shown as it lies" exits 0

printf 'ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n' >still.ply
for file in still.ply builtin:wave:1000; do
    run render $file -q -o no.png --time 1
    holds "$file has no time" exits 1 'expected a glTF or GLB file'
done
run render gone.glb -q -o no.png --time 1
holds "a file that is not there is refused" exits 1 'gone.glb'
sed 's/"VEC3"}\]/"VEC2"}]/' moves.gltf >wrong.gltf
run render wrong.gltf -q -o no.png --time 1
holds "an animation that is wrong is refused" exits 1 'wrong.gltf'
for time in -1 nan x ''; do
    run render moves.gltf -o no.png --time "$time"
    holds "\"$time\" is no time" exits 2 '--time: expected a number from 0 to 1e\+06'
done
holds "no picture is left of what was refused" no test -e no.png

finish
