# animate renders every frame as render does, goes on where it was stopped, and leaves whole files only.
source "$(dirname "$0")/support.sh" "$@"
# Camera and light would be those of the whole animation.
view=(-r 24x16 --camera 0,1,3 --target 0,0,0 --light 5,9,5)
mkdir room

run animate builtin:explode:400 "${view[@]}" -o 'room/f###.png' --frames 3..5 --fps 2 --csv frames.csv --json frames.json
holds "frames are rendered" exits 0 '^3 frames of 24x16 pixels: '
holds "each has its number in its name" is "$(cd room && echo *)" "f003.png f004.png f005.png"
for i in 3 4 5; do
    seconds=$(LC_ALL=C awk "BEGIN { print $i / 2 }")
    run render "builtin:explode:400:$seconds" "${view[@]}" -q -o afresh.png
    holds "frame $i is the picture of $seconds s" cmp -s afresh.png "room/f00$i.png"
done
holds "the CSV has a line a frame" is "$(wc -l <frames.csv)" 4
holds "of as many fields as its head" is "$(tail -n +2 frames.csv | tr -dc ',\n' | sort -u)" "$(head -1 frames.csv | tr -dc ',\n')"
holds "with the frame, its time and its triangles" is "$(sed -n '3p' frames.csv | cut -d, -f1-3)" "4,2.000000,400"
holds "the JSON counts frames" is "$(json frames.json frames)" 3
holds "the JSON says how the tree was built" has_key frames.json plan

# Every option of the tree and of the picture holds.
run animate builtin:explode:400 "${view[@]}" --plan 'split=object trace=restart' --threads 1 --box -q -o 'p#.png' --frames 4 --fps 2
holds "animate takes options of trees and pictures" exits 0
run render builtin:explode:400:2 "${view[@]}" --box -q -o afresh.png
holds "and shows the same" cmp -s afresh.png p4.png

# Resumed
cp room/f004.png whole.png
rm room/f003.png
head -c 100 whole.png >room/f005.png
echo >>room/f004.png # whole, and told from one that is written anew
run animate builtin:explode:400 "${view[@]}" -o 'room/f###.png' --frames 3..5 --fps 2 --resume
holds "frames that are there are left out" exits 0 '^2 frames of 24x16 pixels, 1 left out: '
holds "what is missing is made" is_png room/f003.png
holds "what is whole stays" no cmp -s room/f004.png whole.png
run render builtin:explode:400:2.5 "${view[@]}" -q -o afresh.png
holds "what is not whole is made anew" cmp -s afresh.png room/f005.png
run animate builtin:explode:400 -r 10x10 -o 'room/f###.png' --frames 3..5 --fps 2 --resume
holds "what has another size is made anew" exits 0 '^3 frames of 10x10 pixels: '

# A numbered sequence
for i in 7 8 9 10; do
    printf 'v 0 0 0\nv %s 0 0\nv 0 1 0\nf 1 2 3\n' $i >walk$i.obj
done
printf 'not of it' >walk07.obj
printf 'not of it' >walkx.obj
run animate 'walk#.obj' "${view[@]}" -o 's#.png'
holds "a sequence is rendered, a file a frame" exits 0 '^4 frames of'
for i in 0 1 2 3; do
    run render walk$((i + 7)).obj "${view[@]}" -q -o afresh.png
    run animate 'walk#.obj' "${view[@]}" -q -o 't#.png' --frames $i
    holds "frame $i is file $((i + 7))" cmp -s afresh.png t$i.png
done
run animate 'walk#.obj' "${view[@]}" -q -o 'u#.png' --fps 5 --frames 0..9
holds "behind its end a sequence stays" cmp -s u9.png u4.png
rm walk8.obj
run animate 'walk#.obj' "${view[@]}" -o 's#.png'
holds "a number that is left out is named" exits 1 'walk#.obj: expected the numbers 7 to 10, found none of 8$'
run animate 'run##.obj' "${view[@]}" -o 's#.png'
holds "a sequence without files is refused" exits 1 'run##.obj: there is no file'
run animate 'nowhere/run##.obj' "${view[@]}" -o 's#.png'
holds "so is one in no folder" exits 1 'nowhere/run##.obj: No such file'
printf 'not a mesh' >walk8.obj
rm -f s*.png
run animate 'walk#.obj' "${view[@]}" -o 's#.png' --csv s.csv
holds "a file that is wrong stops it" exits 1 'walk8.obj: '
holds "no picture is made of what is seen to be wrong before" is "$(ls s*.png 2>/dev/null)" ""

# Video, by an encoder that keeps what it gets
mkdir bin
cat >bin/ffmpeg <<'SCRIPT'
#!/bin/sh
for last; do :; done
echo "$@" >arguments
cat >"$last"
SCRIPT
chmod +x bin/ffmpeg
before=$PATH
PATH=$PWD/bin:$before
run animate builtin:explode:400 "${view[@]}" --frames 0..2 --video room/v.mp4 -q
holds "a video is made without pictures" exits 0
holds "it has three frames" is "$(stat -c %s room/v.mp4)" $((3 * 24 * 16 * 3))
holds "the encoder knows their size" grep -q -- '-s 24x16 -r 25 ' arguments
run animate builtin:explode:400 "${view[@]}" --frames 0..2 --video room/w.mp4 -o 'room/f###.png' --resume -q
holds "a video is made with pictures, also those that are there" cmp -s room/v.mp4 room/w.mp4
printf '#!/bin/sh\nexit 3\n' >bin/ffmpeg
rm -f room/*
run animate builtin:explode:400 "${view[@]}" --frames 0..2 --video room/v.mp4
holds "an encoder that fails is an error" exits 1 'room/v.mp4: ffmpeg '
holds "and leaves no video" is "$(ls -A room)" ""
rm bin/ffmpeg
mkdir tools
for tool in cat env sh; do ln -s "$(command -v $tool)" tools/$tool; done
PATH=$PWD/tools
"$kdray" animate builtin:explode:400 "${view[@]}" --frames 0..2 --video room/v.mp4 -o 'room/f#.png' >out 2>err
status=$?
PATH=$before
holds "without ffmpeg nothing is begun" exits 1 'room/v.mp4: a video takes the program ffmpeg, which was not found'
holds "and nothing is left" is "$(ls -A room)" ""

# Stopped
for signal in INT TERM; do
    rm -f room/*
    env --default-signal "$kdray" animate builtin:explode:400 -r 64x64 --spp 16 -o 'room/f####.png' --frames 0..9999 --csv room/all.csv >out 2>err </dev/null &
    job=$!
    while [[ ! -e room/f0001.png ]] && kill -0 $job 2>/dev/null; do sleep 0.05; done
    kill -s $signal $job
    wait $job
    status=$?
    holds "SIG$signal exits with 1 and a sentence" exits 1 '^kdray animate: cancelled after [0-9]+ of 10000 frames'
    whole=0
    for file in room/f*.png; do
        [[ $(tail -c 8 "$file" | od -An -tx1 | tr -d ' \n') != 49454e44ae426082 ]] || whole=$((whole + 1))
    done
    holds "SIG$signal leaves whole frames" is $whole "$(ls room/f*.png | wc -l)"
    holds "and their figures" is "$(($(wc -l <room/all.csv) - 1))" $whole
    holds "and nothing else" is "$(ls -A room | grep -vc '^f[0-9]*\.png$')" 1
done

# Wrong usage
refused() {
    run animate "${@:2}"
    holds "animate ${*:2} is refused" exits 2 "$1"
}
refused 'expected a mesh file'
refused 'expected -o NAME for the pictures, or --video' builtin:wave
refused '--output: expected a name with # for the number' builtin:wave -o x.png
refused '--output: expected # in one place' builtin:wave -o 'x#a#.png'
refused '--frames: expected A..B with A not above B, found "5..4"' builtin:wave -o 'x#.png' --frames 5..4
for frames in x 1.. ..2 1..2..3 -1 ''; do
    refused '--frames: expected a whole number' builtin:wave -o 'x#.png' --frames "$frames"
done
for rate in 0 -1 nan x ''; do
    refused '--fps: expected a number above 0' builtin:wave -o 'x#.png' --fps "$rate"
done
refused '--resume: expected -o' builtin:wave --video x.mp4 --resume
refused 'expected one mesh file' a.ply b.ply -o 'x#.png'
refused '--texture: expected --box' builtin:wave -o 'x#.png' --texture a.png
run animate gone.ply -o 'x#.png'
holds "a file that is not there is refused" exits 1 'gone.ply'
run animate builtin:nothing -o 'x#.png'
holds "a scene that is not there is refused" exits 1 'no built-in scene "nothing"'
run animate builtin:wave -o 'nowhere/x#.png'
holds "a folder that is not there is refused" exits 1 'nowhere/x99.png cannot be written'
run animate walk7.obj -r 8x8 -q -o walk7.obj --frames 0
holds "the mesh file is not written over" exits 1 'would replace the mesh file'
holds "no picture is left of what was refused" is "$(ls x* 2>/dev/null)" ""

finish
