# An accuracy in place of settings.
$ grep -v nodes: small.yaml > auto.yaml; printf 'accuracy: {relative: 0.01, constants: [E1, G12]}\nbudget: {seconds: 60, memory: 1e9}\n' >> auto.yaml; perihom check auto.yaml | grep -A 2 '^# accuracy'
> # accuracy 1 %: begins with 16 x 16 nodes and a grid of about half of them
> # ln(Voigt/Reuss) * error about * nodes
> # solved until 0.001 of the energy *

# What check prints is the case again.
$ perihom check auto.yaml > resolved.yaml; perihom check resolved.yaml | diff resolved.yaml -

$ perihom run auto.yaml
> Small
> *
> accuracy    1 % asked for, error about 0.* %
>             8 x 8 nodes, energy to 1e-03, * operations, * s
>             * nodes, energy to 1e-03, * operations, * s: error about * %
> *why         *
! *perihom: result in auto-results/

$ json_get fidelity.reached < auto-results/result.json; json_get fidelity.chosen.extrapolated < auto-results/result.json; json_get case.microstructure.nodes < auto-results/result.json || echo none
> true
> true
> none

# The same case may be run again; with another accuracy it is another one.
$ perihom run auto.yaml -q > same && perihom run auto.yaml -q --set accuracy.relative=0.02
! perihom: error: auto-results/result.json is the result of another case *
? 5

# A budget that is too small: the best there is, what is missing, code 4 and no file.
$ perihom run auto.yaml --set accuracy.relative=0.0001 --set budget.memory=5e5 -o none | grep -E 'NOT REACHED|missing'
> accuracy    0.01 % asked for, error about *: NOT REACHED
> missing     budget.memory: the next grid, * takes about *
! perihom: error: accuracy 0.01 % is not reached, the error is about *

$ ls none
! ls: *
? 2

$ perihom run auto.yaml --set accuracy.relative=0.0001 --set budget.memory=5e5 -o none -q > out
! perihom: error: *
? 4

# What is given stays.
$ perihom run auto.yaml --set microstructure.nodes=[40,40] --json -q -o given | json_get fidelity.chosen
> *"microstructure.nodes":*40,*40*
