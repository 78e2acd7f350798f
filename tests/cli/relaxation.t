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
