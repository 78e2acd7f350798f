# What a user meets first.
$ perihom
! perihom: effective properties of composites from their microstructure
!
! usage: perihom VERB *
? 2

$ perihom help
> perihom: effective properties of composites from their microstructure
>
> usage: perihom VERB *
> *exit codes: 0 done*

$ perihom --help | head -n 1
> perihom: effective properties of composites from their microstructure

$ perihom rnu small.yaml
! perihom: unknown verb 'rnu'; did you mean 'run'?
! 'perihom help' lists the verbs
? 2

$ perihom optimise small.yaml
! perihom: unknown verb 'optimise'*
! 'perihom help' lists the verbs
? 2

$ perihom help nonsense
! perihom: unknown verb 'nonsense'
! 'perihom help' lists the verbs
? 2

$ perihom run
! perihom run: missing CASE.yaml
! usage: perihom run CASE.yaml \[options]
! 'perihom help run' lists the options
? 2

$ perihom run small.yaml --jsn
! perihom run: unknown option '--jsn'; did you mean '--json'?
! usage: *
! *
? 2

$ perihom run small.yaml -x
! perihom run: unknown option '-x'
! usage: *
! *
? 2

$ perihom run small.yaml other.yaml
! perihom run: one argument too many: 'other.yaml'
! *
? 2

$ perihom run small.yaml -o
! perihom run: -o needs an argument: DIR
! *
? 2

$ perihom run small.yaml --threads=0
! perihom run: --threads: '0' is not an integer from 1 on
! *
? 2

$ perihom run small.yaml --quiet=yes
! perihom run: --quiet takes no argument
! *
? 2

$ perihom list modls
! perihom list: no catalogue 'modls'*
! *
? 2

# Nothing above may leave anything behind.
$ ls
> cracked.yaml
> long.yaml
> relaxing.yaml
> small.yaml
> stubborn.yaml
