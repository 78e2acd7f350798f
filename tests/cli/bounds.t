# Analytic bounds and estimates of a case: every method, or why it does not apply.
$ perihom bounds small.yaml
> Small
>   matrix               0.53*  (matrix)
>   fibre                0.47*
>   seen as a cylinder; moduli in GPa
>*
> method *kind * E1 * E2 * E3 *nu12 *
> voigt *upper *218.61 *
> reuss *lower *111.12 *
> *hashin_shtrikman_lower *lower *131.69 *
> *laminate *estimate  - the phases are not layers*
> *mori_tanaka *estimate *131.69 *131.69 *215.31 *
> *generalised_self_consistent *estimate *

$ perihom bounds small.yaml --json > out.json

$ json_get schema < out.json
> "perihom.bounds/1"

$ json_get shape < out.json
> "cylinder"

$ json_get methods.0.name < out.json
> "voigt"

$ json_get methods.0.engineering.E1 < out.json
> 218.61*

$ json_get methods.6.reason < out.json
> "the phases are not layers"

# In the plane there are the constants of the plane.
$ perihom bounds small.yaml --set microstructure.plane=stress | grep method
> method *kind * E1 * E2 *nu12 *nu21 *G12

# A shape that no formula knows is replaced, and said so; a void takes the lower bounds.
$ perihom bounds small.yaml --set 'microstructure.inclusions=[{shape: box, centre: [0.5, 0.5], size: [0.5, 0.5], material: fibre}]' --set 'materials.fibre={void: true}'
> *fibre                0.25*
> *seen as a cylinder*
> *reuss *lower *= zero: there are voids*
! perihom: inclusions of shape box are taken as a cylinder

# Layers have one answer, whatever their direction.
$ perihom bounds small.yaml --set 'microstructure.inclusions=[{shape: layer, normal: 2, from: 0.0, to: 0.5, material: fibre}]' | sed -n 's/  */ /g; /^laminate/p; /^mori_tanaka/p; /^differential/p' | cut -d ' ' -f 3- | uniq | wc -l
> *1

$ perihom bounds
! perihom bounds: missing CASE.yaml*
? 2

$ perihom bounds no-such-file.yaml
! *no-such-file.yaml*
? 5
