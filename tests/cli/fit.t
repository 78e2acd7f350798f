# Prony series from measurements; the data are synthetic and say of what.
$ perihom fit "$root/data/experiments/resin-relaxation.csv"
> # relaxation data of */resin-relaxation.csv: 81 points, relative residuals
> # misfit 0.00806 (root mean square), 0.0222 (largest), of 81 residuals
> #   terms    misfit       BIC
> #       0  8.21e-01*
> # ?*     8  8.06e-03    -706.3
> *E: {infinity: 0.0198*, terms: ?
>   {modulus: 0.7206*, time: 7.609*e-05},
> *  {modulus: 0.0286*, time: 1068*}?}

# The block is part of a case file as it stands.
$ { printf 'perihom: 1\nunits: {length: mm, stress: GPa, time: s}\nmaterials:\n  resin:\n    nu: 0.4\n'; perihom fit "$root/data/experiments/resin-relaxation.csv" | sed 's/^/    /'; printf 'microstructure: {dimension: 2, plane: strain, size: [1, 1], nodes: [8, 8], matrix: resin}\n'; } > fitted.yaml && perihom check fitted.yaml --json > checked.json && json_get case.materials.resin.E.infinity < checked.json
> 0.0198*

# Several temperatures become one master curve; the law behind the shifts is part of the block.
$ perihom fit "$root/data/experiments/resin-dma.csv" --reference 120 -o dma | tail -n 1
> shift: {wlf: {C1: 14.8*, C2: 54.7*, reference: 120}}

$ ls dma
> fit.csv
> fit.json
> fit.png
> fit.svg
> fit.yaml

$ json_get schema < dma/fit.json && json_get kind < dma/fit.json && json_get shift.factors.3.factor < dma/fit.json && json_get misfit.residuals < dma/fit.json
> "perihom.fit/1"
> "dynamic"
> 1.0
> 208

$ head -n 2 dma/fit.csv
> omega,storage,fit storage,loss,fit loss
> *,2.9*,2.9*,*

# With the true law the same series comes out.
$ perihom fit "$root/data/experiments/resin-dma.csv" --shift wlf:15,55 --reference 120 --json > law.json && json_get shift.found_by < law.json && json_get modulus.terms.8.time < law.json
> "law"
> 98?.*

# Creep is inverted; both series are in the document.
$ perihom fit "$root/data/experiments/resin-creep.csv" --json > creep.json && json_get kind < creep.json && json_get creep.fluidity < creep.json && json_get modulus.infinity < creep.json
> "creep"
> 0.0
> 0.0200*

$ perihom fit "$root/data/experiments/resin-relaxation.csv" --terms 3 --name shear | tail -n 4
> shear: {infinity: 0.0*, terms: ?
>   {modulus: *},
>   {modulus: *},
>   {modulus: *}?}

$ perihom fit "$root/data/experiments/resin-relaxation.csv" --per-decade 1 --fluid --json > grid.json && json_get modulus.infinity < grid.json && json_get steps < grid.json
> 0.0
> ??

$ printf 'zeit;E modul\n1;3\n2;2.5\n4;2.1\n8;2\n' > german.csv; perihom fit german.csv
! *german.csv: needs the columns time and modulus*
? 3

$ perihom fit german.csv --time zeit --modulus 'E modul' --times 1,3 | grep -c modulus
> 2

$ perihom fit german.csv --time zeit --modulus 'E-modul'
! *german.csv: no column 'E-modul' (--modulus); did you mean 'E modul'?
? 3

$ printf 'time,modulus\n1,3\n2,-1\n3,1\n' | perihom fit /dev/stdin
! */dev/stdin:3: column 'modulus': -1 must be > 0
? 3

$ printf 'time,modulus\n0,3\n2,1\n3,1\n' | perihom fit /dev/stdin
! */dev/stdin:2: column 'time': 0 must be > 0
? 3

$ printf 'time,modulus\n1,3\n' | perihom fit /dev/stdin
! */dev/stdin: 1 points: needs 3 to *
? 3

$ printf 'time,modulus\n' | perihom fit /dev/stdin
! */dev/stdin: 0 points: needs 3 to *
? 3

$ printf 'time,modulus\n1,3\n2,\n3,1\n' | perihom fit /dev/stdin
! */dev/stdin:3: column 'modulus': no value*
? 3

$ perihom fit "$root/data/experiments/resin-relaxation.csv" --shift overlap
! *has no column temperature*
? 3

$ perihom fit german.csv --terms 2 --times 1,2
! perihom fit: --terms, --per-decade and --times exclude each other
! *
? 2

$ perihom fit "$root/data/experiments/resin-dma.csv" --reference 120 --shift wlf:15
! perihom fit: --shift is overlap, wlf:C1,C2 or arrhenius:ENERGY*
! *
? 2
