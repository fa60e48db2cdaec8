# kdray bench --frames: every frame of what moves is built and traced by every tracer.
source "$(dirname "${BASH_SOURCE[0]}")/support.sh"

# Embree's threads are none that the sanitizers see.
export TSAN_OPTIONS="ignore_noninstrumented_modules=1:${TSAN_OPTIONS:-}"
export ASAN_OPTIONS="detect_leaks=0:${ASAN_OPTIONS:-}"

# column NAME [FILE]: the values of all rows.
column() {
    awk -F, -v name="$1" '/^#/ { next }
        !at { for (i = 1; i <= NF; i++) if ($i == name) at = i; next }
        { print $at }' "${2:-a.csv}"
}
measure() { run bench -r 24x16 --rounds 2 -t 2 "$@"; }

# A built-in scene, with Embree
measure builtin:explode:600 --frames 3 --only kdray --only embree/low --csv a.csv
holds "frames of a built-in scene are measured" exits 0
holds "the table says how many" grep -q "588 triangles, 3 frames, 24x16 pixels" out
holds "the CSV says how many" grep -q "^# frames: 3;" a.csv
holds "each tracer has a row" is "$(column tracer | tr '\n' ' ')" \
    "kdray/stream kdray/packet kdray/single embree/low/packet embree/low/single "
holds "tracers of one kind agree on the hits of all frames" is "$(column hits | sort -u | wc -l)" 1
holds "there are hits" differs "$(column hits | head -1)" 0
for name in build_ms primary shadow image_ms; do
    holds "$name is a number in every row" is "$(column $name | grep -cE '^[0-9.e+-]+$')" 5
done
for name in ao diffuse; do
    holds "no $name rays are measured" is "$(column $name | grep -c .)" 0
done

# Counts are those of all frames, each with its own mesh: the frames one by one give the same sum.
sum=0
for time in 0 0.25 0.5 0.75; do
    measure "builtin:flake:900" --frames 1 --only kdray/stream --csv one.csv
    sum=$((sum + $(column hits one.csv)))
done
measure builtin:flake:900 --frames 4 --only kdray/stream --csv a.csv
holds "what stands still has the hits of one frame in each" is "$(column hits)" "$sum"

# A sequence of files, one of which moves out of sight, and back
triangle() {
    printf 'v %s 0 0\nv %s 0 0\nv %s 1 0\nf 1 2 3\n' "$1" "$(($1 + 1))" "$1"
}
triangle 0 >walk_1.obj
triangle 5 >walk_2.obj
triangle 0 >walk_3.obj
printf '0.3 0.3 3  0.3 0.3 0  0 1 0  30  3 3 3\n' >walk_#.cam
measure walk_#.obj --frames 3 --only kdray/stream --csv a.csv
holds "a sequence is measured" exits 0
three=$(column hits)
measure walk_1.obj --frames 1 --only kdray/stream --csv one.csv
cp walk_#.cam walk_1.cam
measure walk_1.obj --frames 1 --only kdray/stream --csv one.csv
holds "a frame out of sight has no hits" is "$three" "$((2 * $(column hits one.csv)))"

# Meshes may change their size from frame to frame
triangle 0 >grow_1.obj
{ triangle 0; printf 'v 0 0 -1\nv 1 0 -1\nv 1 1 -1\nf 4 5 6\n'; } >grow_2.obj
measure grow_#.obj --frames 2 --only kdray --only embree --csv a.csv
holds "other numbers of triangles and vertices are taken" exits 0
holds "and all tracers agree" is "$(column hits | sort -u | wc -l)" 1


# Mistakes
for wrong in 0 -1 x 1.5 10001; do
    measure builtin:explode:600 --frames "$wrong"
    holds "--frames $wrong is refused" exits 2 "^kdray bench: --frames: "
done
measure missing_###.ply --frames 2
holds "a sequence without files is a sentence" exits 1 "missing_###.ply"
: >broken_1.obj
triangle 0 >broken_2.obj
printf 'f 1 2 9\n' >broken_3.obj
measure broken_#.obj --frames 3 --only kdray --csv broken.csv
holds "a broken file is a sentence that names it" exits 1 "broken_3.obj"
holds "and leaves no table" no test -e broken.csv

finish
