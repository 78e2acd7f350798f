# Verbs that compute nothing.
$ perihom version
> perihom [0-9]*.[0-9]*.[0-9]* (git *)
> licence   GPL-3.0-or-later
> compiler  *
> libraries *FFTW*

$ perihom version --json | json_get licence
> "GPL-3.0-or-later"

$ perihom --version | head -n 1
> perihom [0-9]*

$ perihom list
> *shapes *
> materials *

$ perihom list shapes
> *disk *valid: *

$ perihom list shapes --json | json_get catalogues.shapes.entries.0.name
> "disk"

$ perihom list routes | grep -c 'valid:'; perihom list routes --json | json_get catalogues.routes.entries.0.name
> 4
> "reduced"

$ perihom list --json | json_get schema
> "perihom.list/1"

# A full disk is an error, a closed pipe is not worth a message.
$ perihom list > /dev/full
! perihom: error: standard output: No space left on device
? 5

$ { perihom list; } | true

$ perihom check small.yaml
> perihom: 1
> title: "Small"
> *# generalised plane strain, 256 nodes, * unknowns
> # phases: matrix 0.5300, fibre 0.4700
> # memory about *, time about *

# What check prints is a case again, and the same one.
$ perihom check small.yaml > resolved.yaml && perihom check resolved.yaml | diff - resolved.yaml

$ perihom check small.yaml --json | json_get schema
> "perihom.check/1"

$ perihom check small.yaml --set microstructure.nodes=\[32,16] --json | json_get estimate.nodes
> 512

# A crack that no bond crosses, said before and after.
$ perihom check cracked.yaml --set sequence= --set 'cracks=[{from: [0.4137, 0.4613], to: [0.4138, 0.4613]}]' | grep 'cut no bond'; perihom run cracked.yaml -q -o uncut --set sequence= --set 'cracks=[{from: [0.4137, 0.4613], to: [0.4138, 0.4613]}]' | grep 'cut no bond'; rm -r uncut
> # 1 of 1 cracks cut no bond and count for nothing: *
> note        1 of 1 cracks cut no bond and count for nothing: *

# Bonds that break: until a crack is through, and if none breaks.
$ perihom check cracked.yaml --set sequence= --set 'failure={matrix: {critical_stretch: 0.01}}' --set 'loading={strain: [0, 1, 0], to: 0.01, steps: 4}' | grep -A 1 '^# memory'
> # memory about *, time about * on one thread
> # that is the time until a crack runs through the cell, * bonds; * if none breaks

$ perihom check missing.yaml
! perihom: error: *missing.yaml*
? 5

$ perihom check small.yaml --set model.kin=local
! small.yaml: *model.kin*kind*
? 3

$ ls
> cracked.yaml
> long.yaml
> relaxing.yaml
> resolved.yaml
> small.yaml
> stubborn.yaml
