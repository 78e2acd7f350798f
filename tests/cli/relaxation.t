# A case whose matrix relaxes, from end to end.
$ perihom run relaxing.yaml
> Relaxing
>
> RVE         16 x 16 nodes, plane stress, periodic
> model *
> relaxation \[GPa] *at once *at last *half at \[s]
>   E1 *
>   isotropic.G *
>
> series      3 terms of *, compressed with error *
>            s          C11          C12          C16
>     infinity *
> route       reduced, * values of s, * iterations, * applications, basis of * fields (*)
>             *, estimated relative error *
! *perihom: result in relaxing-results/

$ ls -A relaxing-results
> dynamic.csv
> dynamic.svg
> phases.png
> prony.csv
> relaxation.csv
> relaxation.svg
> response.csv
> response.svg
> result.json
> tan-delta.svg

$ head -1 relaxing-results/prony.csv; wc -l < relaxing-results/prony.csv
> time,C11,C12,C16,C22,C26,C66
> 5

$ head -c 4 relaxing-results/relaxation.svg
> <svg

$ perihom run relaxing.yaml --json -q -o again > out; json_get effective.viscoelastic.route < out
> "reduced"

# What was not computed is null and not zero; every route's elastic block is that at once.
$ json_get quality.hill_mandel < out; json_get solver.residual.0 < out; grep -c 'route reduced checks the error of the series instead' out
> null
> null
> 3

$ perihom run relaxing.yaml -q -o again | grep '^quality'
> quality     route reduced checks the error of the series instead

$ for route in reduced carson; do perihom run relaxing.yaml --set viscoelastic.route=$route -q -o $route-at-once 2> said | grep '^  E1 ' | head -n 1 | cut -c 1-20; done | uniq | wc -l
> 1

# The resolved case is a case of the same meaning.
$ perihom check relaxing.yaml > resolved.yaml && perihom check resolved.yaml | diff resolved.yaml - && grep -A1 'viscoelastic:' resolved.yaml
> viscoelastic:
>   route: "reduced"

$ perihom check relaxing.yaml | grep '^# relax'
> # relaxation by route reduced; relaxation times \[s]: matrix 1

# A relaxing material with other keys, and a route that is not there.
$ perihom run relaxing.yaml --set viscoelastic.route=rduced -o c
! *--set viscoelastic.route: 'rduced' is not admissible: must be reduced, carson, stepping or frequency; did you mean 'reduced'?
? 3

# Bounds at once and at equilibrium; a melt has none at equilibrium.
$ perihom bounds relaxing.yaml | grep -c '^hashin_shtrikman_lower'; perihom bounds relaxing.yaml | grep '^At'
> 2
> At once (time 0)
> At equilibrium (time infinity)

$ perihom bounds relaxing.yaml --json > b; json_get equilibrium.methods.0.name < b
> "voigt"

$ perihom bounds relaxing.yaml --set 'materials.matrix={bulk: 4, shear: {infinity: 0, terms: [{modulus: 1, time: 1}]}}' | grep -c '^voigt'
> 1
! *no bounds at equilibrium: material 'matrix': its stiffness at s = 0 is singular

$ perihom view relaxing-results
> relaxing-results/relaxation.png
> relaxing-results/dynamic.png
> relaxing-results/tan-delta.png
> relaxing-results/response.png

$ perihom run relaxing.yaml --set viscoelastic.route=carson --json -q -o carson > out 2> said; cat said; json_get effective.viscoelastic.terms < out; json_get effective.viscoelastic.carson.0.s < out; ls carson
> relaxing.yaml:16: warning: viscoelastic.terms: route carson does not use it: it has no effect
> relaxing.yaml:17: warning: viscoelastic.history: route carson does not use it: it has no effect
> null
> 0.1
> phases.png
> result.json

# Routes without a series write what they computed.
$ perihom run relaxing.yaml --set viscoelastic.route=stepping --set 'viscoelastic.times=[1,2]' -q -o step > out 2> said; ls step; head -1 step/relaxation.csv; grep -c '^ *[12]  ' out
> phases.png
> relaxation.csv
> relaxation.svg
> response.csv
> response.svg
> result.json
> time,C11,C12,C16,C22,C26,C66
> 2

$ perihom run relaxing.yaml --set viscoelastic.route=frequency --set 'viscoelastic.frequencies=[1]' --json -q -o freq > out 2> said; json_get solver.converged < out; head -1 freq/dynamic.csv
> true
> omega,C11_storage,C11_loss,C12_storage,C12_loss,C16_storage,C16_loss,C22_storage,C22_loss,C26_storage,C26_loss,C66_storage,C66_loss

# A modulus that drowns in the residual is an error: 1e-8 of the stiff phase, solved to 1e-6.
$ perihom run relaxing.yaml --set viscoelastic.route=frequency --set 'materials.matrix={nu: 0.38, E: {infinity: 0, terms: [{modulus: 17, time: 1}]}}' --set 'viscoelastic.frequencies=[1e-8]' --set viscoelastic.tolerance=1e-4 -q -o drowned 2> said; echo $?; grep -c 'frequency 1e-08: .*ask for a lower solver.tolerance' said; test ! -e drowned/result.json
> 4
> 1

# Single precision is that of solves to a residual: not of reduced, which bounds energies.
$ perihom run relaxing.yaml --set solver.precision=single --set model.points=stress -o single
! perihom: error: precision single cannot take route reduced, which is solved in double: take carson or stepping, or precision double
? 3

$ perihom run relaxing.yaml --set solver.precision=single --set model.points=stress --set viscoelastic.route=frequency --set 'viscoelastic.frequencies=[1]' -o single 2>&1 | tail -n 1
> perihom: error: precision single cannot take route frequency, *

$ perihom run relaxing.yaml --set solver.precision=single --set model.points=stress --set viscoelastic.route=carson --json -q -o single 2> said | json_get solver.precision
> "single"
