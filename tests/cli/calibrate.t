# Calibrations: what is printed, what is kept, what is refused.
$ cp "$root"/tests/cli/calibrate/*.yaml .; printf 'percent,E,sd\n1,3.6,0.05\n2.5,3.8,0.05\n5,4.1,0.06\n' > clay.csv

$ perihom calibrate kappa.yaml
> kappa
>
> kappa
>   value               *
>   standard error      *(data *, sampling *)
>   95 % interval       * to *
>   identifiable        known
>
> quantity   weight_fraction   measured *
> E1                    0.01        3.6       0.05 *
> E1                   0.025        3.8       0.05 *
> E1                    0.05        4.1       0.06 *
>
> misfit * with 2 degrees of freedom, probability of a larger one *
> rms of residuals *
! perihom: * realisations solved, 0 read back; result in kappa-results/

# Nothing is solved twice, and the same comes out.
$ perihom calibrate kappa.yaml --json -q > again.json

$ perihom calibrate kappa.yaml > /dev/null
! perihom: 0 realisations solved, * read back; result in kappa-results/

$ json_get schema < again.json
> "perihom.calibration/1"

$ json_get unknowns.kappa.key < again.json
> "microstructure.fillers.0.interphase.kappa"

$ json_get unknowns.kappa.identifiable < again.json
> "known"

$ json_get points.1.measured < again.json
> 3.8*

$ ls kappa-results
> calibration.json
> evaluations.jsonl
> model-E1.svg
> profile-kappa.svg

# Another case in the same folder is refused.
$ perihom calibrate kappa.yaml --set model.horizon=4
! perihom: error: kappa-results/evaluations.jsonl holds the evaluations of another case*
? 5

# What a calibration file can get wrong: line, key, value, what is admissible.
$ printf 'calibration: 1\ncase: tiny-clay.yaml\nunknowns: {a.b: {from: 2, to: 1}}\nbudgt: {}\ndata: {file: clay.csv, columns: {E1: F, Q9: E}}\n' > bad.yaml; perihom calibrate bad.yaml
! bad.yaml:3: unknowns.a.b.to: 1 is not admissible: must be larger than from, 2
! bad.yaml:4: budgt: unknown key: *did you mean 'budget'?
! bad.yaml:5: data.columns.E1: 'F' is not admissible: ./clay.csv has the columns percent, E and sd
? 3

$ printf 'calibration: 1\ncase: tiny-clay.yaml\nunknowns: {microstructure.fillers.0.interphase.kapa: {from: 1, to: 2}}\ndata: {file: clay.csv, columns: {E1: E}}\n' > bad.yaml; perihom calibrate bad.yaml
! ./tiny-clay.yaml: *kapa: unknown key*did you mean 'kappa'?
? 3

$ sed 's/E1: E, sigma: sd/E1: E/; s/kappa: {/kappa: {name: x, /' kappa.yaml > nosigma.yaml; perihom calibrate nosigma.yaml -q | grep relative.error
> misfit *, relative error of the data *

$ printf 'percent,E,sd\n1,3.6,0.05\n2.5,x,0.05\n' > clay.csv; perihom calibrate kappa.yaml
! perihom: error: ./clay.csv:3: *'x'*
? 3

$ printf 'percent,E,sd\n1,3.6,0.05\n2.5,3.8,\n' > clay.csv; perihom calibrate kappa.yaml
! perihom: error: ./clay.csv:3: sigma of E1 is nan: must be > 0
? 3

$ printf 'percent,E,sd\n,3.6,0.05\n' > clay.csv; perihom calibrate kappa.yaml
! perihom: error: ./clay.csv:2: column 'percent': no number, but * of the case comes from it
? 3

$ printf 'percent,E,sd\n1,,0.05\n' > clay.csv; perihom calibrate kappa.yaml
! perihom: error: ./clay.csv: no measured value
? 3

$ perihom calibrate none.yaml
! perihom: error: none.yaml: *
? 5

# What the calibration sets itself cannot come from elsewhere too; names are unique.
$ printf 'percent,E,sd\n1,3.6,0.05\n2.5,0,0.05\n' > clay.csv; perihom calibrate kappa.yaml -o untouched --set microstructure.fillers.0.interphase.kappa=3; perihom calibrate kappa.yaml -o untouched --set microstructure.fillers.0.weight_fraction=0.03; test -e untouched || echo no folder
! perihom: error: --set microstructure.fillers.0.interphase.kappa: the calibration sets this key*
! perihom: error: --set microstructure.fillers.0.weight_fraction: the calibration sets this key*
> no folder

$ sed 's/columns: {/columns: {microstructure.fillers.0.interphase.kappa: percent, /' kappa.yaml > bad.yaml; perihom calibrate bad.yaml
! bad.yaml:5: data.columns.microstructure.fillers.0.interphase.kappa: is an unknown*
? 3

$ sed 's/start: 1}/start: 1, name: x}, materials.clay.E: {from: 100, to: 200, name: x}/' kappa.yaml > bad.yaml; perihom calibrate bad.yaml
! bad.yaml:4: unknowns.materials.clay.E.name: 'x' is not admissible: is the name of another unknown
? 3

$ sed 's/start: 1}/start: 1}, materials.clay.E: {from: 100, to: 200, also: [microstructure.fillers.0.interphase.kappa]}/' kappa.yaml > bad.yaml; perihom calibrate bad.yaml
! bad.yaml:4: unknowns.materials.clay.E.also.0: *: is an unknown already
? 3

# What no realisation can give is refused before one is solved.
$ sed 's/E1: E/fraction.dirt: E/' kappa.yaml > bad.yaml; perihom calibrate bad.yaml
! perihom: error: bad.yaml: data.columns: fraction.dirt: the case has no material 'dirt'
? 3

$ sed 's/, sigma: sd//' kappa.yaml > bad.yaml; perihom calibrate bad.yaml
! perihom: error: ./clay.csv:3: E1 is 0: it has no relative error, give a sigma
? 3

$ ls -d bad-results 2>&1 | grep -c cannot
> 1

# Cracks are random too: a mean over three realisations, with an error of sampling.
$ printf '%s\n' 'perihom: 1' 'materials: {m: {E: 3.5, nu: 0.3333333333333333}}' 'microstructure: {dimension: 2, plane: stress, size: [16, 16], nodes: [16, 16], matrix: m, interface: node_centre}' 'model: {kind: bond, horizon: 2}' 'cracks: [{random: {count: 2, length: 4}}]' > cracked.yaml; printf '%s\n' 'calibration: 1' 'case: cracked.yaml' 'unknowns: {materials.m.E: {from: 1, to: 10}}' 'data: {file: c.csv, columns: {E1: E, sigma: 0.1}}' 'budget: {relative_error: 0.9, at_least: 3, realisations: 3}' > c.yaml; printf 'E\n3.3\n' > c.csv; perihom calibrate c.yaml -q | grep '^E1'
> E1                3.3        0.1 *nan     3
