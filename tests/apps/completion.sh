# Completions know every long option that --help lists, and the man page says what --help says.
source "$(dirname "$0")/support.sh" "$@"
folder=$project/apps/kdray/completion

run --help
sed -n '/^Commands:/,/^$/s/^  \([a-z][a-z]*\) .*/\1/p' out >commands
holds "there are commands" test "$(wc -l <commands)" -ge 2

# shellcheck disable=SC1091
source "$folder/kdray.bash"
# complete_line WORD...: what bash would offer for the last word; in $offers
complete_line() {
    COMP_WORDS=("$@")
    COMP_CWORD=$(($# - 1))
    _kdray
    offers=" ${COMPREPLY[*]} "
}

page=$(dirname "$kdray")/kdray.1
while read -r command; do
    complete_line kdray ""
    holds "bash offers the command $command" grep -qF " $command " <<<"$offers"
    run "$command" --help
    grep -oE '^ +(-., )?--[a-z-]+' out | grep -oE -- '--[a-z-]+' >options
    holds "$command has options" test "$(wc -l <options)" -ge 5
    while read -r option; do
        complete_line kdray "$command" "$option"
        holds "bash knows $command $option" grep -qF " $option " <<<"$offers"
        holds "zsh knows $option" grep -qE -- "[')},{(*]${option}[]=})[']" "$folder/_kdray"
        holds "fish knows $option" grep -qE -- "-l ${option#--}( |$)" "$folder/kdray.fish"
        [[ ! -s $page ]] || holds "the man page knows $option" grep -qF -- "${option//-/\\-}" "$page"
    done <options
done <commands

complete_line kdray render --isa av
holds "bash completes instruction sets" is "$offers" " avx2 avx512 "
complete_line kdray render --isa = sc
holds "bash completes after an equals sign" is "$offers" " scalar "
touch mesh.ply
complete_line kdray info me
holds "bash completes files" is "$offers" " mesh.ply "
complete_line kdray info bu
holds "bash offers built-in scenes" is "$offers" " builtin: "
complete_line "$kdray" info builtin : fla
holds "bash completes their names" is "$offers" " flake "
finish
