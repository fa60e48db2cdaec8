# A plan as text reaches the build of every command, is told back whole, and is refused with a sentence.
source "$(dirname "$0")/support.sh" "$@"

between='order=dfs share=none events=2 straddle=auto retract=no box-weight=0 empty-bonus=1'
usual="split=binned axis=best $between traversal-cost=16 intersection-cost=1 leaf-limit=64 depth-limit=0 reference-limit=0 lazy-limit=0 trace=auto nodes=structures mailbox=0 test=watertight"

# The list of keys: each can be given with what the default plan has
run info --plans
holds "--plans needs no file" exits 0
holds "--plans says nothing else" empty err
cut -d' ' -f1 out >keys
holds "there are keys" test "$(wc -l <keys)" -ge 10
while IFS= read -r line; do
    holds "a key has its default: $line" grep -q 'default ' <<<"$line"
done <out
for word in $usual; do
    holds "${word%%=*} is listed" grep -qx "${word%%=*}" keys
    run info "$scene" -q --json - --plan "$word"
    holds "$word is the default" is "$(json out plan)" "$usual"
done
holds "--plans lists values" grep -qE '^split +binned\|space\|object\|sweep, ' <("$kdray" info --plans)

# info
run info "$scene" -q --json -
holds "the default plan is told" is "$(json out plan)" "$usual"
cost=$(json out tree cost)
run info "$scene" -q --json - --plan ""
holds "an empty plan is the default one" is "$(json out plan) $(json out tree cost)" "$usual $cost"
for plan in split=space split=object axis=robin axis=longest "split=space axis=best" "split=object axis=robin" \
    "leaf-limit=2 traversal-cost=1" depth-limit=3 split=sweep "split=sweep straddle=clip" share=grid/9; do
    run info "$scene" -q --json - --plan "$plan"
    holds "a tree is built by $plan" exits 0
    holds "$plan builds another tree" differs "$(json out tree cost)" "$cost"
    for word in $plan; do
        holds "the plan told has $word" grep -qF " $word " <<<" $(json out plan) "
    done
    told=$(json out plan)
    cp out first.json
    run info "$scene" -q --json - --plan "$told"
    holds "what was told of $plan builds the same tree" is "$(json out plan) $(json out tree leaves)" \
        "$told $(json first.json tree leaves)"
done

# Options are applied in the order given.
run info "$scene" -q --json - --plan "split=object leaf-limit=4" --leaf-limit 5
holds "an option after a plan changes it" is "$(json out plan)" \
    "split=object axis=longest $between traversal-cost=16 intersection-cost=1 leaf-limit=5 depth-limit=0 reference-limit=0 lazy-limit=0 trace=auto nodes=structures mailbox=0 test=watertight"
run info "$scene" -q --json - --leaf-limit 5 --plan "depth-limit=7"
holds "a plan replaces what came before it" is "$(json out plan)" "${usual/depth-limit=0/depth-limit=7}"

# Traversals by name
for plan in trace=stack "trace=restart nodes=arrays" "trace=push-down mailbox=8" trace=short-stack trace=backtrack \
    "trace=stack test=moller-trumbore" "trace=restart test=projection"; do
    run info "$scene" -q --json - --plan "$plan"
    holds "$plan builds the same tree" is "$(json out tree cost)" "$cost"
    for word in $plan; do
        holds "the plan told has $word" grep -qF " $word " <<<" $(json out plan) "
    done
done

# render and bench
picture plain.png
for split in binned space object sweep; do
    picture "$split.png" --plan "split=$split" --json "$split.json"
    holds "split=$split leaves the picture alone" cmp -s plain.png "$split.png"
    holds "render tells the plan" grep -q "^split=$split " <<<"$(json "$split.json" plan)"
done
for trace in stack restart push-down short-stack backtrack; do
    picture "$trace.png" --plan "trace=$trace"
    holds "trace=$trace leaves the picture alone" cmp -s plain.png "$trace.png"
done
run bench "$scene" -r 8x8 --rounds 1 --only kdray --plan "split=space leaf-limit=9" --csv -
holds "bench runs by a plan" exits 0
holds "its CSV tells the plan" grep -qE '^# plan: split=space axis=longest .* leaf-limit=9 ' out

run bench "$scene" -r 8x8 --rounds 1 --only kdray --plan "split=space leaf-limit=9" --json -
holds "every row of its JSON tells the plan" is \
    "$(grep -cE '"plan": "split=space axis=longest .* leaf-limit=9 ' out) $(grep -c '"tracer": ' out)" "3 3"

# What is refused
refuses() {
    local plan=$1 sentence=$2 command
    for command in render info bench; do
        run "$command" "$scene" --plan "$plan"
        holds "$command refuses $plan: $sentence" exits 2 "^kdray $command: --plan: $sentence\$"
        holds "$command prints nothing then" empty out
    done
}
refuses split=middle 'split: expected binned, space, object or sweep, found "middle"'
refuses 'split=space axis=z' 'axis: expected best, longest or robin, found "z"'
refuses leaf-limit=0 'leaf-limit: expected a whole number from 1 to 4294967295, found "0"'
refuses traversal-cost=nan 'traversal-cost: expected a number above 0 and at most 1e\+06, found "nan"'
refuses trace=best 'trace: expected auto, stack, restart, push-down, short-stack or backtrack, found "best"'
refuses nodes=arrays 'nodes=arrays goes with trace=stack or trace=restart'
refuses mailbox=8 'a mailbox goes with a traversal by name, not with trace=auto'
refuses test=projection 'another triangle test goes with a traversal by name, not with trace=auto'
refuses 'axis=best axis=best' 'axis: expected it once, found "axis=best" as well'
refuses space 'expected KEY=VALUE with one of the keys quality, split, axis, .* or test, found "space"'
finish
