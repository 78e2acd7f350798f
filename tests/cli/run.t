# One case from end to end.
$ perihom run missing.yaml
! perihom: error: *missing.yaml*
? 5

$ ls -d *-results
! ls: *
? 2

$ perihom run small.yaml
> Small
>
> RVE         16 x 16 nodes, generalised plane strain, periodic
> model       nosb*
> phases      matrix 0.5300, fibre 0.4700
>
> engineering constants       +- \[%]       Reuss .. Voigt
>   E1    *GPa     +- *..*
> *stiffness \[GPa], Voigt 11 22 33 23 13 12, engineering shear*
> solver      *; iterations *; residual *
> quality     Hill-Mandel *
> cost        * thread*
! *perihom: result in small-results/

$ ls -A small-results
> phases.png
> result.json

$ json_get schema < small-results/result.json
> "perihom.result/1"

# stdout is one document, whatever stderr says.
$ perihom run small.yaml --json -v -o a/b 2> talk | json_get effective.notation; grep -c iteration talk > many; test $(cat many) -gt 6
> "voigt 11 22 33 23 13 12, engineering shear"

$ ls -A a/b
> phases.png
> result.json

# The document on stdout is the document in the folder.
$ perihom run small.yaml --json -q -o same > same.json && json_get '' < same.json > t1 && json_get '' < same/result.json | diff - t1

# -q: nothing but data.
$ perihom run small.yaml -q -o quiet > /dev/null

# The bar comes where it is asked for, and never on stdout.
$ perihom run small.yaml --progress -o bar 2>&1 > /dev/null | tr '\r' '\n' | grep -c 'ETA' > bars; test $(cat bars) -ge 1

# A small grid takes one thread, whatever is offered: the bits are the same.
$ perihom run small.yaml -qj2 -o two > /dev/null && json_get cost.threads < two/result.json
> 1

# The same case may be run again; another one may not take its place.
$ perihom run small.yaml -q > /dev/null

$ perihom run small.yaml -q --set microstructure.nodes=\[8,8]
! perihom: error: small-results/result.json is the result of another case ('Small'); choose another folder with -o, or overwrite it with --force
? 5

$ json_get case.microstructure.nodes < small-results/result.json
> \[16,16]

$ perihom run small.yaml -q --set microstructure.nodes=\[8,8] --set output.fields=true --force > /dev/null && ls -A small-results
> fields.h5
> fields.xdmf
> phases.png
> result.json

# Files that the new result does not have do not stay from the old one.
$ perihom run small.yaml -q --force > /dev/null && ls -A small-results
> phases.png
> result.json

$ mkdir strange && echo hello > strange/result.json && perihom run small.yaml -q -o strange
! perihom: error: strange/result.json is there and is not a result of perihom; *
? 5

$ cat strange/result.json
> hello

# Folders that cannot be written are found before the work is done.
$ perihom run small.yaml -q -o small.yaml
! perihom: error: small.yaml is not a folder
? 5

$ perihom run small.yaml -q -o small.yaml/in
! perihom: error: small.yaml/in: Not a directory
? 5

$ mkdir locked && chmod 555 locked && if test -w locked; then echo 'perihom: error: locked/in: cannot write into locked: Permission denied' >&2; (exit 5); else perihom run small.yaml -q -o locked/in; fi
! perihom: error: locked/in: cannot write into locked: Permission denied
? 5

# Not converged: the report, no result.
$ perihom run stubborn.yaml -q
> Stubborn
> *NOT CONVERGED*
! perihom: error: *
? 4

$ perihom run stubborn.yaml -q --json 2> /dev/null | json_get solver.converged
> false

$ ls -d stubborn-results
! ls: *
? 2

# A result that stdout could not take is an error, but it is kept.
$ perihom run small.yaml -q -o full > /dev/full
! perihom: error: standard output: No space left on device
? 5

$ ls -A full
> phases.png
> result.json

# A contrast at which a residual of 1e-6 says nothing of the directions across the fibres, which
# the stiffness along them must not hide: no number is better than a wrong one.
$ perihom run small.yaml -q --set materials.fibre.E=1e14 -o extreme > /dev/null; echo $?; ls extreme 2>&1 | grep -c 'No such'
> 4
> 1
! perihom: error: the error of the stress averages is * of the effective tensor: *

# Two cases into one folder at once: the one that ends first is kept, the other one says so.
$ perihom run small.yaml -q -o both --set microstructure.nodes=[192,192] >/dev/null 2>talk & perihom run small.yaml -q -o both >/dev/null 2>>talk; a=$?; wait $!; echo $((a + $?)); grep -c 'result of another case' talk; ls -A both
> 5
> 1
> phases.png
> result.json

# Cracks: a row a step, here and in the folder; cut through is no failure.
$ perihom run cracked.yaml -q > cracked; grep -c 'the stiffness has no inverse' cracked; sed -n '/^damage/,/^ *1 /p' cracked | cut -c 1-38,50-61
> 1
> damage
>   crack length \[m]   density   E1/E1(0) anisotropy
>                  0         0    1.00000 *
>                0.5    0.0625    0.99*
>                  1      0.25    1.00000        inf

$ ls -A cracked-results
> damage-law.csv
> damage.csv
> damage.png
> phases.png
> result.json

$ json_get effective.damage.steps.1.broken_bonds < cracked-results/result.json
> 88

$ json_get effective.damage.steps.2.anisotropy_index < cracked-results/result.json
> null

$ perihom view cracked-results
> cracked-results/damage-moduli.png
> cracked-results/damage-anisotropy.png

# With fields, a picture of every step, one scale for all.
$ perihom run cracked.yaml -q -o steps --set output.fields=true >/dev/null; perihom view steps --field displacement2 --load 22
> steps/displacement2-load22.png
> steps/displacement2-load22_0000.png
> steps/displacement2-load22_0001.png
> steps/displacement2-load22_0002.png

$ perihom view steps --field damage
> steps/damage_0000.png
> steps/damage_0001.png
> steps/damage_0002.png

$ perihom view steps --field dammage
! perihom*no field 'dammage'*
? 3

# Random cracks of which half of one is more than all that is asked for: none would be there.
$ perihom run cracked.yaml -q -o none --set 'cracks=[{random: {density: 0.1, length: 0.9}}]' --set sequence=null
! perihom: error: line *: cracks.0.random.length: no crack is placed: one of length 0.9 has density 0.2025, more than twice the 0.1 *
? 3

$ perihom run cracked.yaml -q -o few --set 'cracks=[{random: {density: 0.1, length: 0.5}}]' --set 'sequence={density: [0.02, 0.0625, 0.1]}' | grep -o '(density asked.*'
> (density asked 0.02, reached 0)
> (density asked 0.1, reached 0.125)

# A loading below every strength: no energies of events, no peak. A law of two knots says so.
$ perihom run cracked.yaml -q -o whole --set sequence=null --set 'failure={matrix: unbreakable}' --set 'loading={strain: [0, 1, 0], to: -0.01, steps: 2}' | sed -n '/^failure/,/^$/p'
> failure
>   no bond broke
>   no peak: stress still rises at the end of the loading, to -*

$ perihom run cracked.yaml -q -o torn --set 'cracks=[]' --set sequence=null --set 'failure={matrix: {critical_stretch: 0.01}}' --set 'loading={strain: [1, 1, 0], to: 100, steps: 2, break: together}' | grep -o -e 'asymmetry [^,]*' -e 'note  *the damage law.*'
> asymmetry 0.0e+00
> note        the damage law has 2 knots: loading.stiffness_every: 1 records every step

# Precision: used as asked, said in the document; what has no single is refused before a solve.
$ perihom run small.yaml -q --json --set model.points=stress --set solver.precision=single -o floats > floats.json; json_get solver.kind < floats.json; json_get solver.precision < floats.json; json_get case.solver.precision < floats.json
> "fft_cg"
> "single"
> "single"

$ perihom run small.yaml --set model.points=nodes --set solver.precision=single -o never
! small.yaml: --set solver.precision: 'single' is not admissible: precision single cannot take this case: it takes points stress with their smallest family, or model local
? 3

$ perihom check small.yaml --set model.points=nodes --set solver.precision=single
! small.yaml: --set solver.precision: 'single' is not admissible: precision single cannot take this case: *
? 3

$ perihom check small.yaml --set solver.precision=auto --set model.points=stress | grep precision
>   precision: "auto"
> # precision: double (below a tolerance of 1e-5 floats are refined, which gains little)

$ perihom list precisions | grep -v ' valid:\| ref:'
> double * 53 bits
> single * 24 bits, *
> auto * single where *

# One constant is one load; what its mean stress and the symmetry of the cell say beside is there, the rest is null.
$ perihom run small.yaml --set 'output={constants: [E1]}' --json -q -o one > one.json; test "$(json_get effective.engineering.E1 < one.json)" = "$(json_get effective.constants.E1 < one.json)" && echo same; json_get cost.loads < one.json; json_get effective.engineering.nu12 < one.json; json_get effective.engineering.E2 < one.json; json_get effective.engineering.G12 < one.json
> same
> 1
> 0.*
> *
> null
