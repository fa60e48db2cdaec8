# Wrong usage exits with 2 and names what was expected; what cannot be done exits with 1. Neither leaves a file.
source "$(dirname "$0")/support.sh" "$@"

refuses() {
    local pattern=$1
    shift
    run "$@"
    holds "$* exits with 2 and says: $pattern" exits 2 "$pattern"
    holds "$* prints nothing" empty out
    holds "$* writes no picture" no test -e x.png
}
fails() {
    local pattern=$1
    shift
    run "$@"
    holds "$* exits with 1 and says: $pattern" exits 1 "$pattern"
    holds "$* says one sentence" is "$(wc -l <err)" 1
    holds "$* writes no picture" no test -e x.png
}

# Commands
refuses 'kdray: expected a command'
refuses 'kdray: expected a command, found "paint"' paint
refuses 'expected a mesh file' render
refuses 'expected a mesh file' render -o x.png
refuses 'expected -o FILE' render "$scene"
refuses 'one mesh file, found "b.ply"' render a.ply b.ply -o x.png
refuses 'not stdout' render "$scene" -o -
refuses 'unrecognized option' render "$scene" -o x.png --bogus
refuses 'requires an argument' render "$scene" -o
refuses 'another file' render "$scene" -o x.png --json x.png
refuses 'another file' render "$scene" -o x.png --json ./x.png
refuses 'another file' render "$scene" -o x.png --json "$PWD/x.png"
mkdir real
ln -s real linked
ln -s "$PWD/linked/y.png" y.json
ln -s loop loop
refuses 'another file' render "$scene" -o real/y.png --json linked/y.png
refuses 'another file' render "$scene" -o real/y.png --json y.json
refuses 'another file' render "$scene" -o loop --json loop
run render "$scene" "${size[@]}" -q -o real/y.png --json real/y.json
holds "files of one directory are told apart" exits 0
holds "the picture is a picture" is_png real/y.png
holds "the JSON is JSON" has_key real/y.json triangles
refuses 'expected --box' render "$scene" -o x.png --texture a.png
refuses 'expected --compare' render "$scene" -o x.png --threshold 3
refuses 'expected a mesh file' info
refuses 'one mesh file' info a b
refuses 'expected no mesh file' info --scenes a
refuses '^kdray info: --plans: expected no mesh file, found "a"' info --plans a
refuses 'expected --scenes or --plans' info --scenes --plans

# Numbers: whole words, finite, in range
number() {
    local option=$1 expected=$2 value
    shift 2
    for value in "$@"; do
        refuses "^kdray render: $option: expected $expected, found \"" render "$scene" -o x.png "$option=$value"
    done
}
number --resolution 'WIDTHxHEIGHT, each from 1 to 65536' '' 1 x 0x5 5x0 65537x1 4x4x4 '4 x4' -4x4 4X4 4x4k 1e2x4
number --threads 'a whole number from 1 to 256' '' 0 257 -1 +1 1.5 2x ' 2' 99999999999999999999999
number --spp 'a whole number from 1 to 65536' 0 65537 many
number --seed 'a whole number from 0 to 18446744073709551615' -1 18446744073709551616 0x10
for option in --camera --target --up --light; do
    number $option 'three finite numbers X,Y,Z' '' 1 1,2 1,2, 1,2,3,4 1,2,nan inf,0,0 1e39,0,0 '1, 2,3' 1,2,0x3 a,b,c
done
number --fov 'a number above 0 and below 180' 0 180 -3 nan inf 45deg ''
number --traversal-cost 'a number above 0 and at most 1e\+06' 0 -1 nan 1e7 x
number --intersection-cost 'a number above 0 and at most 1e\+06' 0 -1 inf 1e7 x
number --leaf-limit 'a whole number from 1 to 4294967295' 0 -1 4294967296 x
number --depth-limit 'a whole number from 0 to 60' 61 -1 x
number --reference-limit 'a number from 1 to 1e\+06' 0.99 nan x
number --isa 'scalar, sse42, avx2, avx512 or neon' '' SSE42 mmx
refuses '^kdray render: --threshold: expected a number from 0 to 255' render "$scene" --compare a.png --threshold 256
refuses '^kdray info: --threads: expected a whole number' info "$scene" -t zero
lights=()
for i in {1..17}; do lights+=(--light 1,1,1); done
refuses 'at most 16 lights' render "$scene" -o x.png "${lights[@]}"

# Files that are not there, or not what they should be
fails '^kdray render: .*none.ply.*No such file' render none.ply -o x.png
fails '^kdray info: .*none.ply.*No such file' info none.ply
fails 'builtin|built-in' render builtin:nothing -o x.png
echo "this is no mesh" >junk.ply
fails 'junk.ply' render junk.ply -o x.png
fails 'none.cam.*No such file' render "$scene" -o x.png --view none.cam
echo "1 2 3" >short.cam
fails 'short.cam' render "$scene" -o x.png --view short.cam
fails 'none.png.*No such file' render "$scene" -o x.png --box --texture none.png
fails 'junk.ply' render "$scene" -o x.png --box --texture junk.ply
fails 'camera' render "$scene" "${size[@]}" -o x.png --camera 1,1,1 --target 1,1,1
run render "$scene" "${size[@]}" -o x.png --isa neon
if [[ $(uname -m) == x86_64 ]]; then
    holds "an instruction set that is not there is refused" exits 1 '^kdray render: --isa: neon is not there to use'
fi
KDR_ISA=nonsense run render "$scene" "${size[@]}" -o x.png
holds "a wrong KDR_ISA is refused" exits 1 'KDR_ISA'

# Files that cannot be written are found before the work: a mesh that is not there is not even looked for.
mkdir folder
for name in folder none/x.png /proc/x.png junk.ply/x.png folder/ '' "$(printf 'n%.0s' {1..300}).png"; do
    fails 'cannot be written' render none.ply -o "$name"
    fails 'cannot be written' render none.ply -o x.png --json "$name"
    fails 'cannot be written' info none.ply --json "$name"
done
if ((EUID != 0)); then
    chmod a-w folder
    fails 'cannot be written: Permission denied' render none.ply -o folder/x.png
fi
holds "looking for what can be written leaves nothing" is "$(ls -A folder; ls -A | grep kdray-)" ""
cp junk.ply same.ply
fails 'would replace the mesh file' render same.ply -o same.ply
fails 'would replace the mesh file' info same.ply --json same.ply
holds "the mesh file is still what it was" cmp -s junk.ply same.ply
finish
