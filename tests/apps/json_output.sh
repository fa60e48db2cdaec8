# The JSON of a render has every key, in a file or on stdout, and is JSON whatever the names.
source "$(dirname "$0")/support.sh" "$@"

keys=(file image width height triangles dropped threads isa load_ms build_ms trace_ms primary_rays hits shadow_rays occluded)
tree=(triangles dropped degenerate nodes interior leaves empty_leaves references depth largest_leaf mean_leaf_depth cost
    duplication node_bytes leaf_bytes bytes_per_triangle build_ms depth_histogram leaf_histogram)
picture x.png --json x.json
for key in "${keys[@]}"; do holds "JSON has $key" has_key x.json "$key"; done
for key in "${tree[@]}"; do holds "JSON has the tree's $key" has_key x.json tree "$key"; done
holds "JSON says the size" is "$(json x.json width)x$(json x.json height)" 24x16
holds "one primary ray a pixel" is "$(json x.json primary_rays)" $((24 * 16))
holds "one shadow ray a hit" is "$(json x.json shadow_rays)" "$(json x.json hits)"
holds "no more occluded than asked" test "$(json x.json occluded)" -le "$(json x.json shadow_rays)"
holds "JSON names the scene" is "$(json x.json file)" "$scene"
holds "JSON names the picture" is "$(json x.json image)" x.png
picture y.png --json y.json --spp 4 --light 1,9,1 --light 9,9,9
holds "four samples are four rays" is "$(json y.json primary_rays)" $((4 * 24 * 16))
holds "two lights are two shadow rays a hit" is "$(json y.json shadow_rays)" $((2 * $(json y.json hits)))

picture z.png --json -
holds "--json - prints JSON" has_key out tree cost
picture z.png --json - --stats
holds "--stats keeps off that stdout" has_key out tree cost
holds "--stats goes to stderr then" grep -q duplication err
ln -s real.json link.json
echo old >real.json
picture z.png --json link.json
holds "a link stays a link" test -L link.json
holds "and what it leads to is new" has_key real.json hits

# Names of every kind of byte
strange=$'a "quoted"\\ \t\x01 \xc3\xa9 \xff\xc0\xaf \xed\xa0\x80.png'
picture "$strange" --json strange.json
holds "a strange name makes JSON" has_key strange.json image
holds "quotes and control characters are escaped" grep -qF 'a \"quoted\"\\ \u0009\u0001 ' strange.json
holds "UTF-8 stays" grep -qF $'\xc3\xa9 ' strange.json
holds "what is no UTF-8 is escaped" grep -qF '\ufffd\ufffd\ufffd \ufffd\ufffd\ufffd.png' strange.json
finish
