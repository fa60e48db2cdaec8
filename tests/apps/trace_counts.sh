# info --trace prints what rays cost, in a build that counts, and says so in any other.
source "$(dirname "$0")/support.sh" "$@"

run info builtin:flake:2000 --trace
if [[ $KDR_COUNTING != ON ]]; then
    holds "--trace is refused by a build that does not count" exits 1 '--trace: expected a build that counts'
    holds "nothing is printed then" empty out
    run info builtin:flake:2000 --trace --json trace.json
    holds "no file is written then" no test -e trace.json
else
    holds "--trace is done by a build that counts" exits 0
    for way in packets "lone rays" stack restart push-down short-stack backtrack; do
        for kind in primary shadow ao diffuse; do
            holds "$way are counted for $kind rays" grep -qE "^  $way +$kind +[0-9]+ +[0-9.]+ " out
        done
    done
    run info builtin:flake:2000 --trace --json - --plan trace=restart
    holds "JSON alone is printed" exits 0
    holds "a traversal by name is the only one" is "$(json out trace 0 traversal)" restart
    holds "there are four kinds of rays of it" is "$(json out trace 3 rays)" diffuse
    holds "there is nothing else" no has_key out trace 4
    holds "every pixel has a primary ray" is "$(json out trace 0 ray_count)" 65536
    holds "rays hit" test "$(json out trace 0 hit_count)" -gt 1000
    holds "nodes are visited" test "$(json out trace 0 nodes)" -gt 65536
fi
run info --trace --plans
holds "--trace wants a mesh" exits 2 '--trace: expected a mesh file, found --plans'

finish
