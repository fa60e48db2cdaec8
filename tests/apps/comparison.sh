# --compare measures, and its threshold decides.
source "$(dirname "$0")/support.sh" "$@"

picture reference.png
run render "$scene" "${size[@]}" -q --compare reference.png
holds "a picture is the same as itself" exits 0
holds "the difference is printed" is "$(cat out)" "difference 0.000000"
holds "-o is not needed to compare" is "$(echo *.png)" reference.png
run render "$scene" -q --compare reference.png -o copy.png
holds "the size is that of the reference" is "$(png_size copy.png)" 24x16
holds "a picture that is compared is written too" cmp -s reference.png copy.png

picture other.png --light -9,3,1
run render "$scene" -q --compare other.png
difference=$(sed -n 's/^difference //p' out)
holds "another light is a difference above 2" exits 1 "^kdray render: the picture differs from other.png by $difference, more"
run render "$scene" -q --compare other.png --threshold 255
holds "--threshold lets it pass" exits 0
run render "$scene" -q --compare other.png --threshold "$difference" --json -
holds "the JSON carries the difference" has_key out difference
holds "text keeps off a stdout that carries JSON" grep -q '^difference ' err
run render "$scene" -q --compare other.png --threshold 0 -o anyway.png --json anyway.json
holds "too great a difference fails" exits 1
holds "the picture is written all the same" is_png anyway.png
holds "so is the JSON" has_key anyway.json difference

run render "$scene" -q -r 25x16 --compare reference.png
holds "sizes must be equal" exits 1 'reference.png has 24x16 pixels, the picture 25x16'
run render "$scene" -q --compare missing.png
holds "a missing reference is named" exits 1 'missing.png.*No such file'
finish
