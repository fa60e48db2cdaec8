# Completion of kdray for bash.

_kdray() {
    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command=${COMP_WORDS[1]}
    local build='--threads --isa --json --quiet --plan --traversal-cost --intersection-cost --leaf-limit
        --depth-limit --reference-limit --help --usage --version'
    COMPREPLY=()

    if ((COMP_CWORD == 1)); then
        mapfile -t COMPREPLY < <(compgen -W 'render animate view info bench --help --version' -- "$word")
        return
    fi

    # "--option=value" comes as three words.
    if [[ $word == = ]]; then
        word=''
    elif [[ $before == = ]]; then
        before=${COMP_WORDS[COMP_CWORD - 2]}
    fi
    case $before in
    --isa)
        mapfile -t COMPREPLY < <(compgen -W 'scalar sse42 avx2 avx512 neon' -- "$word")
        return
        ;;
    --only)
        mapfile -t COMPREPLY < <(compgen -W 'kdray embree' -- "$word")
        return
        ;;
    --show)
        mapfile -t COMPREPLY < <(compgen -W 'picture normals depth nodes triangles' -- "$word")
        return
        ;;
    -o | --output | --screenshot | --view | --texture | --compare | --json | --csv | --video)
        compopt -o filenames 2>/dev/null
        mapfile -t COMPREPLY < <(compgen -f -- "$word")
        return
        ;;
    --slice)
        mapfile -t COMPREPLY < <(compgen -W 'x=50% y=50% z=50%' -- "$word")
        return
        ;;
    -r | --resolution | -t | --threads | --spp | --seed | --time | --camera | --target | --up | --fov | --light | --threshold | \
        --rounds | --frames | --fps | --plan | --traversal-cost | --intersection-cost | --leaf-limit | --depth-limit | --reference-limit)
        return
        ;;
    esac

    if [[ $word == -* ]]; then
        local options=''
        local camera='--view --camera --target --up --fov --light'
        local picture="--output --resolution --spp --seed $camera --box --texture"
        case $command in
        render) options="$picture --time --compare --threshold --stats $build" ;;
        animate) options="$picture --frames --fps --resume --video --csv $build" ;;
        view) options="--resolution --show --fps --paused --frames --screenshot $camera $build" ;;
        info) options="--scenes --plans --slice --output --trace $build" ;;
        bench) options="--resolution --rounds --frames --only --csv $build" ;;
        esac
        mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
        return
    fi

    # A colon parts words for bash: "builtin:NAME" comes as three.
    if [[ $word == : || $before == : ]]; then
        [[ $word != : ]] || word=''
        mapfile -t COMPREPLY < <(compgen -W "$("${COMP_WORDS[0]}" info --scenes 2>/dev/null | cut -d' ' -f1)" -- "$word")
        return
    fi
    compopt -o filenames 2>/dev/null
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
    [[ -z $word || builtin: != "$word"* ]] || COMPREPLY+=(builtin:)
}

complete -F _kdray kdray
