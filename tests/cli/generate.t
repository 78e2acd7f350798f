# The microstructure alone: its numbers, its picture, its voxels. The circle crosses 26 + 26
# lines of the grid, one cell a crossing.
$ perihom generate small.yaml
> cells       16 x 16
> cut cells   52
>
>   value  material              fraction   at cell centres
>       0  matrix                0.530000   0.*
>       1  fibre                 0.470000   0.*
! perihom: small-results/phases.png, small-results/phases.npy

$ ls -A small-results
> phases.npy
> phases.png

$ perihom generate small.yaml --json -q -o here/there | json_get schema
> "perihom.microstructure/1"

$ perihom generate small.yaml --json -q -o here/there | json_get cut_cells
> 52

$ ls -A here/there
> phases.npy
> phases.png

# node_centre: the fractions are those of the centres.
$ perihom generate small.yaml -q --set microstructure.interface=node_centre
> *
> cut cells   0
> *

# What was written is a case again.
$ printf 'perihom: 1\ntitle: Again\nmaterials: {a: {E: 1, nu: 0.3}, b: {E: 2, nu: 0.3}}\nmicrostructure: {dimension: 2, plane: strain, size: [1, 1], voxels: {file: here/there/phases.npy, materials: [a, b]}}\n' > again.yaml; perihom generate again.yaml -q
> cells       16 x 16
> cut cells   0
> *

$ cmp again-results/phases.npy here/there/phases.npy

# A folder with the result of another case is left alone.
$ perihom run small.yaml -q -o taken > /dev/null && perihom generate again.yaml -o taken
! perihom: error: taken/result.json is the result of another case*
? 5

$ perihom generate small.yaml --set microstructure.inclusions.0.radius=-1
! small.yaml*radius*
? 3

$ perihom generate
! perihom generate: *
! usage: *
! *
? 2

# Random fillers: counts, statistics, pictures; another realisation is another picture, the
# same one the same; and what was written is a case again.
$ printf 'perihom: 1\nmaterials: {m: {E: 1, nu: 0.3}, f: {E: 2, nu: 0.3}}\nmicrostructure: {dimension: 2, plane: strain, size: [64, 64], nodes: [64, 64], matrix: m, interface: node_centre, fillers: [{shape: fibre, material: f, volume_fraction: 0.1, thickness: 2, length: 20, placement: {gap: 1}}]}\n' > fillers.yaml; perihom generate fillers.yaml -q -o one > /dev/null; ls one
> correlation.png
> fillers.png
> microstructure.h5
> microstructure.xdmf
> phases.h5
> phases.npy
> phases.png

$ perihom generate fillers.yaml -q -o one --json | json_get fillers.0.count
> 10

$ perihom generate fillers.yaml -q -o two --set microstructure.realisation=1 > /dev/null; cmp -s one/phases.npy two/phases.npy || echo differs
> differs

$ OMP_NUM_THREADS=2 perihom generate fillers.yaml -q -o three > /dev/null; cmp one/phases.npy three/phases.npy && cmp one/phases.h5 three/phases.h5

$ printf 'perihom: 1\nmaterials: {m: {E: 1, nu: 0.3}, f: {E: 2, nu: 0.3}}\nmicrostructure: {dimension: 2, plane: strain, size: [64, 64], voxels: {file: one/phases.h5, owners: /owner, materials: [m, f]}}\n' > back.yaml; perihom generate back.yaml -q > /dev/null; cmp one/phases.npy back-results/phases.npy
