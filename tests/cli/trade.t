# What accuracy costs.
$ perihom trade small.yaml --knobs nodes,tolerance --finest 12 -q
> Small
> * settings: * solved, 0 refused, 0 failed, 0 skipped
> reference: own finest grid, 144 nodes, extrapolated with *; its own error about * %
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
