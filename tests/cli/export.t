# Material cards.
$ perihom run small.yaml -q > /dev/null && perihom export small-results --to calculix --name ply
> \*\* Small
> \*\* perihom * units: length um, stress GPa, time s
> \*\* ply, orthotropic; relative distance from the effective tensor *
> \*MATERIAL, NAME=ply
> \*ELASTIC, TYPE=ENGINEERING CONSTANTS
> *

$ perihom export small-results/result.json --to code_aster -o ply.comm && grep -c ELAS_ORTH ply.comm
> 1

$ perihom export small-results --to openradioss
! perihom: error: the material is not isotropic: the nearest such tensor is 0.* of its norm away (tolerance 1e-05); *
? 3

$ perihom export small-results --to openradioss --nearest | grep -c /MAT/ELAST
> 1
! perihom: the card is 0.* of the tensor's norm away from the result

$ perihom export small-results
! perihom export: --to FORMAT is missing
! *
? 2

$ perihom export small-results --to abacus
! perihom export: unknown format 'abacus'; did you mean 'abaqus'?
! *
? 2

$ perihom export small-results --to abaqus --symmetry cubic
! perihom export: --symmetry is isotropic, orthotropic or anisotropic, not 'cubic'
! *
? 2

$ perihom export nowhere --to abaqus
! perihom: error: nowhere: cannot be opened: No such file or directory
? 5

$ perihom run small.yaml -q -o flat --set microstructure.plane=stress > /dev/null && perihom export flat --to abaqus
! *a plane stress result has no constants out of the plane*generalised_strain*
? 3
