# Completion of kdray for fish.

function __kdray_scenes
    kdray info --scenes 2>/dev/null | string replace -r '^(\S+)\s+' 'builtin:$1\t'
end

complete -c kdray -n __fish_use_subcommand -f -a render -d 'a picture of a mesh file'
complete -c kdray -n __fish_use_subcommand -f -a info -d 'what a mesh and its tree are made of'
complete -c kdray -n __fish_use_subcommand -f -a bench -d 'speed'
complete -c kdray -l help -d 'list the options'
complete -c kdray -l version -d 'print the version'

set -l any '__fish_seen_subcommand_from render info bench'
complete -c kdray -n $any -a '(__kdray_scenes)'
complete -c kdray -n $any -l usage -d 'list the options in short'
complete -c kdray -n $any -s t -l threads -x -d 'threads that build and trace'
complete -c kdray -n $any -l isa -x -a 'scalar sse42 avx2 avx512 neon' -d 'instruction set'
complete -c kdray -n $any -l json -r -d 'write every figure as JSON'
complete -c kdray -n $any -s q -l quiet -d 'say nothing but errors'
complete -c kdray -n $any -l traversal-cost -x -d 'cost of a step through an interior node'
complete -c kdray -n $any -l intersection-cost -x -d 'cost of a triangle test'
complete -c kdray -n $any -l leaf-limit -x -d 'split every leaf of more triangles'
complete -c kdray -n $any -l depth-limit -x -d 'deepest leaf'
complete -c kdray -n $any -l reference-limit -x -d 'most references a triangle'

set -l render '__fish_seen_subcommand_from render'
complete -c kdray -n $render -s o -l output -r -d 'write the picture to this PNG file'
complete -c kdray -n $render -s r -l resolution -x -d 'pixels'
complete -c kdray -n $render -l spp -x -d 'samples a pixel'
complete -c kdray -n $render -l seed -x -d 'seed of the positions of the samples'
complete -c kdray -n $render -l view -r -d 'read eye, target, up, field of view and light'
complete -c kdray -n $render -l camera -x -d 'where the eye is'
complete -c kdray -n $render -l target -x -d 'what it looks at'
complete -c kdray -n $render -l up -x -d 'which way is up'
complete -c kdray -n $render -l fov -x -d 'vertical field of view'
complete -c kdray -n $render -l light -x -d 'a point light'
complete -c kdray -n $render -l box -d 'put the model in a textured box'
complete -c kdray -n $render -l texture -r -d 'PNG file on the box'
complete -c kdray -n $render -l compare -r -d 'print the difference from this PNG file'
complete -c kdray -n $render -l threshold -x -d 'largest difference that passes'
complete -c kdray -n $render -l stats -d 'print every figure'

complete -c kdray -n '__fish_seen_subcommand_from info' -l scenes -d 'list the built-in scenes'

set -l bench '__fish_seen_subcommand_from bench'
complete -c kdray -n $bench -s r -l resolution -x -d 'pixels'
complete -c kdray -n $bench -l rounds -x -d 'times that everything is measured'
complete -c kdray -n $bench -l only -x -d 'measure this tracer'
complete -c kdray -n $bench -l csv -r -d 'write comma separated values'
