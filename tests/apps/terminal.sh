# Progress is for terminals.
source "$(dirname "$0")/support.sh" "$@"
escape=$'\033'

# on_terminal COMMAND: runs it on a terminal of its own; what the terminal got is in out.
on_terminal() {
    script -qec "$1" /dev/null >out 2>err </dev/null
    status=$?
}
render="'$kdray' render $scene -r 96x64 --spp 16 -o x.png"

TERM=xterm on_terminal "$render"
holds "a render on a terminal is done" exits 0
holds "the step before the rays is named" grep -q 'building' out
holds "progress has a percentage, time gone and time left" grep -qE '100%.*, ETA [0-9]+ s' out
holds "progress is coloured" grep -qF "$escape[32m" out
holds "the line is cleared at the end" grep -qF $'\r'"$escape[K" out
holds "what follows begins at the left" grep -qE "\[K[0-9]+ triangles" out

NO_COLOR=1 TERM=xterm on_terminal "$render"
holds "NO_COLOR has progress" grep -q '100%' out
holds "NO_COLOR has no colour" no grep -qF "$escape[32m" out

TERM=dumb on_terminal "$render"
holds "a dumb terminal has progress" grep -q '100%' out
holds "a dumb terminal gets no escape sequence" no grep -qF "$escape" out

TERM=xterm on_terminal "$render --quiet"
holds "--quiet shows nothing on a terminal" empty out

TERM=xterm on_terminal "stty cols 30; $render"
holds "a narrow terminal is done" exits 0
holds "progress fits a narrow terminal" is "$(sed "s/$escape\[[0-9]*[mK]//g" out | tr '\r' '\n' | grep % |
    awk 'length > 29' | wc -l)" 0

TERM=xterm on_terminal "$render 2>plain"
holds "a file for stderr gets the summary alone" is "$(wc -l <plain)" 1
run render "$scene" "${size[@]}" -o x.png
holds "a pipe gets the summary alone" is "$(wc -l <err)" 1
holds "a pipe gets no control character" no grep -qP '[\x00-\x08\x0b-\x1f]' err

# Ctrl-C on the terminal, in the middle of the work
TERM=xterm on_terminal "timeout --foreground -s INT 1 '$kdray' render $scene -r 512x512 --spp 65536 -o long.png; echo status \$?"
holds "Ctrl-C says so" grep -q 'kdray render: .*cancelled' out
holds "Ctrl-C leaves no picture" no test -e long.png

# Bars fit the terminal.
for columns in 24 40 79 200; do
    TERM=xterm on_terminal "stty cols $columns; '$kdray' info builtin:sphere:2000"
    holds "bars fit $columns columns" is "$(tr -d '\r' <out | grep '#' | awk -v n="$columns" 'length > n' | wc -l)" 0
done
holds "bars are drawn" grep -q '####' out
finish
