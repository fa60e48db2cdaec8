# Files appear whole or not at all: cancelled, out of room, or with nobody to read.
source "$(dirname "$0")/support.sh" "$@"
mkdir room

# long_render NAME: a render of minutes that gets signal NAME while it traces. Signals have their default meaning, even
# where this script runs under nohup.
long_render() {
    env --default-signal "$kdray" render "$scene" -r 512x512 --spp 65536 -o room/x.png --json room/x.json >out 2>err </dev/null &
    local job=$!
    sleep 1
    kill -s "$1" "$job"
    wait "$job"
    status=$?
}
for signal in INT TERM HUP; do
    long_render "$signal"
    holds "SIG$signal exits with 1 and a sentence" exits 1 '^kdray render: .*cancelled$'
    holds "SIG$signal gets one sentence" is "$(wc -l <err)" 1
    holds "SIG$signal leaves no file" is "$(ls -A room)" ""
done

# Before there is anything to cancel, a signal ends the program at once.
mkfifo pipe
"$kdray" render pipe -o room/x.png >out 2>err </dev/null &
job=$!
sleep 0.5
kill -s TERM "$job"
wait "$job"
status=$?
holds "a signal while loading exits with 1" exits 1 '^kdray render: cancelled$'
holds "a signal while loading leaves no file" is "$(ls -A room)" ""

# Under nohup, work outlives the terminal: SIGHUP is ignored from the start, and stays so.
trap '' HUP
"$kdray" render pipe "${size[@]}" -q -o room/x.png >out 2>err </dev/null &
job=$!
trap - HUP
sleep 0.5
kill -s HUP "$job"
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' 1<>pipe # which waits for no reader
wait "$job"
status=$?
holds "nohup keeps a render going" exits 0
holds "its picture is whole" is_png room/x.png
rm -f room/*

# A disk with no room: a limit on the size of files, and the device that is always full
(
    ulimit -f 1
    "$kdray" render "$scene" -r 64x64 -q -o room/x.png >/dev/null 2>err.limited
    echo $? >status.limited
)
status=$(cat status.limited)
cp err.limited err
holds "a picture without room exits with 1" exits 1 'room/x.png.*File too large'
holds "a picture without room leaves no file" is "$(ls -A room)" ""
(
    ulimit -f 1
    "$kdray" info "$scene" -q --json room/x.json >/dev/null 2>err.limited
    echo $? >status.limited
)
status=$(cat status.limited)
cp err.limited err
holds "JSON without room exits with 1" exits 1 'room/x.json.*File too large'
holds "JSON without room leaves no file" is "$(ls -A room)" ""
run render "$scene" "${size[@]}" -q -o /dev/full
holds "a full device exits with 1" exits 1 '/dev/full.*No space left'
run render "$scene" "${size[@]}" -q -o room/x.png --json /dev/full
holds "JSON to a full device exits with 1" exits 1 '/dev/full.*No space left'
rm -f room/*

# An older file keeps its contents when the new one fails.
picture room/x.png
cp room/x.png before.png
(
    ulimit -f 1
    "$kdray" render "$scene" -r 64x64 -q -o room/x.png 2>/dev/null
)
holds "the older picture is still there" cmp -s before.png room/x.png
holds "and nothing else" is "$(ls -A room)" x.png

# stdout: full, closed, or a pipe that nobody reads
to_stdout() {
    local what=$1
    shift
    "$kdray" "$@" >/dev/full 2>err
    status=$?
    holds "$what to a full stdout exits with 1" exits 1 'stdout cannot be written: No space left'
    "$kdray" "$@" >&- 2>err
    status=$?
    holds "$what to a closed stdout exits with 1" exits 1 'stdout cannot be written'
    {
        sleep 0.2 # the reader is gone by then
        "$kdray" "$@" 2>err
        echo $? >status
    } | true
    status=$(cat status)
    holds "$what to a pipe nobody reads exits with 1" exits 1 'stdout cannot be written: Broken pipe'
}
to_stdout help --help
to_stdout "help of a command" render --help
to_stdout version --version
to_stdout scenes info --scenes
to_stdout info info "$scene" -q
to_stdout JSON render "$scene" "${size[@]}" -q -o room/x.png --json -
to_stdout statistics render "$scene" "${size[@]}" -q -o room/x.png --stats
"$kdray" render "$scene" "${size[@]}" -q -o closed.png >&- 2>&- <&-
status=$?
holds "a render that prints nothing needs no stdout" exits 0
holds "its picture is whole" cmp -s closed.png before.png
finish
