# Cases that are larger than any machine are refused before they fill it, with what they take.
$ perihom run small.yaml --set 'microstructure={dimension: 3, size: [1, 1, 1], nodes: [65536, 65536, 256], matrix: matrix}'
! perihom: error: the case takes at least 7* of memory and * are here: fewer microstructure.nodes take less
? 5

$ perihom check small.yaml --set 'microstructure={dimension: 3, size: [1, 1, 1], nodes: [65536, 65536, 256], matrix: matrix}'
! perihom: error: the case takes at least 7* of memory and * are here: *
? 5

$ perihom generate small.yaml --set 'microstructure={dimension: 3, size: [1, 1, 1], nodes: [65536, 65536, 256], matrix: matrix}'
! perihom: error: the case takes at least 2* of memory and * are here: *
? 5

$ perihom bounds small.yaml --set 'microstructure={dimension: 3, size: [1, 1, 1], nodes: [65536, 65536, 256], matrix: matrix}'
! perihom: error: the case takes at least 2* of memory and * are here: *
? 5

# The cells fit below the limit of the process, the solver does not. (A program with a
# sanitizer in it does not start below any limit.)
$ (ulimit -v 600000; perihom version >/dev/null 2>&1 || exit 5; perihom run small.yaml -q -j 1 --set microstructure.nodes=[2048,2048] 2>talk); code=$?; test ! -s talk || grep -q 'takes .* 614 MB are here' talk && exit $code
? 5

$ (ulimit -v 600000; perihom version >/dev/null 2>&1 || echo 'run will refuse it'; perihom check small.yaml --set microstructure.nodes=[2048,2048] 2>/dev/null) | grep -o 'run will refuse it'
> run will refuse it

$ ls -d *-results
! ls: *
? 2

# An empty name is no folder: it would be the root.
$ perihom run small.yaml -o ''
! perihom: error: the name of the folder is empty
? 5

$ perihom generate small.yaml -o ''
! perihom: error: the name of the folder is empty
? 5
