# Every option of render does what it says.
source "$(dirname "$0")/support.sh" "$@"

picture plain.png
holds "two runs make the same file" picture again.png
holds "two runs make the same bytes" cmp -s plain.png again.png

# Size
holds "-r sets the pixels" is "$(png_size plain.png)" 24x16
picture long.png --resolution=7x31
holds "--resolution sets the pixels" is "$(png_size long.png)" 7x31
run render builtin:sphere:100 -q -o default.png
holds "a picture has 1024x1024 pixels if nothing else is said" is "$(png_size default.png)" 1024x1024

# What must change the picture, each option alone
changes() {
    picture changed.png "$@"
    holds "$* changes the picture" no cmp -s plain.png changed.png
}
changes --camera 9,1,2
changes --target 0.3,0.2,0.1
changes --up 1,0,0
changes --fov 20
changes --light 9,-3,1
changes --box
changes --spp 4
changes --light 1,5,1 --light -5,1,1
echo "3 4 5  0 0 0  0 1 0  40  9 9 9" >one.cam
changes --view one.cam

# A view is the same as its parts, and an option replaces its own part only.
picture view.png --view one.cam
picture parts.png --camera 3,4,5 --target 0,0,0 --up 0,1,0 --fov 40 --light 9,9,9
holds "--view is eye, target, up, field of view and light" cmp -s view.png parts.png
picture mixed.png --fov 60 --view one.cam
picture mixed_parts.png --camera 3,4,5 --target 0,0,0 --up 0,1,0 --fov 60 --light 9,9,9
holds "--fov replaces that of the view" cmp -s mixed.png mixed_parts.png
picture lit.png --view one.cam --light -9,9,9
picture lit_parts.png --camera 3,4,5 --target 0,0,0 --up 0,1,0 --fov 40 --light -9,9,9
holds "--light replaces that of the view" cmp -s lit.png lit_parts.png

# Sixteen lights
lights=()
for i in {1..16}; do lights+=(--light "$i,20,-$i"); done
picture sixteen.png "${lights[@]}"
holds "sixteen lights are another picture" no cmp -s plain.png sixteen.png

# The box and its texture
picture box.png --box
picture textured.png --box --texture plain.png
holds "--texture changes the box" no cmp -s box.png textured.png

# Seeds place the samples; one sample goes through the middle of its pixel.
picture seed1.png --spp 3 --seed 1
picture seed2.png --spp 3 --seed 18446744073709551615
holds "--seed moves the samples" no cmp -s seed1.png seed2.png

# What must not change the picture
for same in "-t 1" "--threads=3" "--isa scalar" "--traversal-cost 5" "--intersection-cost 3.5e0" "--leaf-limit 1" \
    "--depth-limit 3" "--reference-limit 1" "--plan=split=space" "--plan split=object"; do
    # shellcheck disable=SC2086
    picture same.png $same
    holds "$same leaves the picture alone" cmp -s plain.png same.png
done

# ... but the figures
figures() {
    picture figures.png --json figures.json "$@"
}
figures
holds "--threads is 1 or more if not given" test "$(json figures.json threads)" -ge 1
depth=$(json figures.json tree depth)
leaves=$(json figures.json tree leaves)
largest=$(json figures.json tree largest_leaf)
references=$(json figures.json tree references)
cost=$(json figures.json tree cost)
figures -t 3
holds "-t sets the threads" is "$(json figures.json threads)" 3
figures --isa scalar
holds "--isa sets the instruction set" is "$(json figures.json isa)" scalar
figures --depth-limit 3
holds "--depth-limit holds" test "$(json figures.json tree depth)" -le 3
holds "the tree is deeper without it" test "$depth" -gt 3
figures --leaf-limit 4
holds "--leaf-limit splits more" test "$(json figures.json tree leaves)" -gt "$leaves"
holds "--leaf-limit makes the largest leaf smaller" test "$(json figures.json tree largest_leaf)" -lt "$largest"
figures --reference-limit 1
holds "--reference-limit holds down references" test "$(json figures.json tree references)" -lt "$references"
figures --traversal-cost 50
holds "--traversal-cost counts in the cost" differs "$(json figures.json tree cost)" "$cost"
figures --intersection-cost 50
holds "--intersection-cost counts in the cost" differs "$(json figures.json tree cost)" "$cost"

# Text
run render "$scene" "${size[@]}" -o text.png
holds "a summary goes to stderr" exits 0 '^2[0-9]* triangles, 24x16 pixels: load .* build .* trace .* Mray/s$'
holds "stdout is empty without --stats" empty out
run render "$scene" "${size[@]}" -o text.png --quiet
holds "--quiet says nothing" empty err
run render "$scene" "${size[@]}" -o text.png --stats
for word in primary hits shadow occluded load build trace triangles nodes leaves depth cost duplication bytes; do
    holds "--stats prints $word" grep -qE "^  $word +[0-9]" out
done
run render --help
holds "--help lists --resolution" grep -q -- '--resolution=WxH' out
run render --version
holds "--version prints the version" grep -qE '^kdray [0-9]+\.[0-9]+\.[0-9]+$' out
finish
