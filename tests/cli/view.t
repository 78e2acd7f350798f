# Pictures of a result.
$ perihom run small.yaml -q --set output.fields=true > /dev/null && perihom view small-results --field stress11 --load 11
> small-results/stress11-load11.png

$ perihom view small-results --field phases -o pictures
> pictures/phases.png

$ perihom view small-results -q -o pictures --load 1 && ls pictures | grep -c load11
> 16

$ perihom view small-results --field stres11
! *no field 'stres11'*
? 3

$ perihom view small-results --axis 4
! perihom view: --axis is 1, 2 or 3, got 4
! *
? 2

$ perihom run small.yaml -q -o bare > /dev/null && perihom view bare
! perihom view: 'bare' holds no .h5 file: run with --set output.fields=true for one
? 5

$ perihom view nowhere
! *nowhere*
? 5
