# What accuracy costs.
$ perihom trade small.yaml --knobs nodes,tolerance --finest 12 -q
> Small
> * settings: * solved, 0 refused, 0 failed, 0 skipped
> reference: own finest grid, 12 x 12 nodes, extrapolated with 6 x 6; its own error about * %
>
> front: nothing cheaper is better
> *%*microstructure.nodes=*
> 3 %: *
>     perihom run small.yaml --set 'microstructure.nodes=*' *-j 1
> *

$ ls small-trade
> rows.jsonl
> seconds.svg
> trade.csv
> trade.html
> trade.json
> work.svg

$ json_get schema < small-trade/trade.json
> "perihom.trade/1"

# Rows are kept: the same document comes out without a solution.
$ cp small-trade/rows.jsonl before; perihom trade small.yaml --knobs nodes,tolerance --finest 12 --json -q > again.json; cmp before small-trade/rows.jsonl && head -c -1 again.json | cmp - small-trade/trade.json

$ perihom trade small.yaml --constants E1,G12 --reference E1=140,G12=46 --knobs nodes --finest 8 -o known | grep reference
> reference: given: E1=140,G12=46
! perihom: figures in known/trade.html

# What the call sets is not repeated where the setting sets it anew.
$ perihom trade small.yaml --set microstructure.nodes=[10,10] --set solver.tolerance=1e-5 --knobs nodes --finest 12 -o anew -q | grep 'perihom run' | head -n 1
>     perihom run small.yaml --set solver.tolerance=1e-5 --set 'microstructure.nodes=*' -j 1

# One grid is no reference of itself.
$ perihom trade small.yaml --budget 1e-9 -o poor -q
> Small
> *
> reference: none: only one grid of the case is solved; would not fit into the budget of 1e-09 s
! perihom: error: *
? 4

$ json_get reference.values.E1 < poor/trade.json; json_get complete < poor/trade.json
> null
> false

# A crack that ends through leaves a case without a solution: no error is invented.
$ perihom trade cracked.yaml --finest 12 -q -o severed
> Cracked
> *settings:*
> reference: none: the case itself is not solved; *inverse*
! perihom: error: *
? 4

# Nor does a given reference make it one that is solved.
$ perihom trade cracked.yaml --finest 12 -q -o severed-known --reference E1=1 --knobs nodes >/dev/null
! perihom: error: the case itself is not solved: *inverse*
? 4

$ perihom trade "$root/data/cases/delayed-debonding.yaml" -q -o breaking
! perihom: error: a trade is of effective constants, not of bonds that break: the case has a loading
? 3

$ perihom trade small.yaml --reference E1=0
! perihom: error: reference: E1 is 0: no error is relative to that; name other constants
? 3

$ perihom trade small.yaml --knobs nodse
! perihom: error: no knob 'nodse'; did you mean 'nodes'?
? 3

$ perihom trade small.yaml --finest 1
! perihom trade: --finest: 1 is not from 6 to 65536 nodes
! *
? 2

$ perihom trade small.yaml --budget soon
! perihom trade: --budget: 'soon' is not a number of seconds > 0
! *
? 2

$ perihom trade missing.yaml
! perihom: error: *missing.yaml*
? 5

$ perihom list knobs | head -n 1
> nodes *cells along each axis
