#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""CalculiX reads our cards: a cube under a uniform strain must carry the stress of the tensor
that the card came from, whatever the class of its symmetry, and a bar under axial traction must
become as long as the compliance says.

usage: calculix.py ROOT PERIHOM      prints TAP; exit 77 without ccx
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile

root, perihom = sys.argv[1], os.path.abspath(sys.argv[2])
ccx = shutil.which("ccx")
if not ccx:
    print("1..0 # SKIP no ccx (package calculix-ccx)")
    sys.exit(77)

ISOTROPIC = """perihom: 1
materials: {one: {E: 3.5, nu: 0.35, density: 1.2}}
microstructure: {dimension: 3, size: [1, 1, 1], nodes: [4, 4, 4], matrix: one}
"""
SKEW = """perihom: 1
materials: {soft: {E: 3.5, nu: 0.35}, stiff: {E: 70, nu: 0.2}}
microstructure:
  dimension: 3
  size: [1, 1, 1]
  nodes: [12, 12, 12]
  matrix: soft
  inclusions: [{shape: ellipsoid, centre: [0.5, 0.5, 0.5], semi_axes: [0.45, 0.25, 0.15],
                axis: [1, 2, 3], material: stiff}]
"""
ORTHOTROPIC = SKEW.replace("axis: [1, 2, 3]", "axis: [1, 0, 0]")

# Strain 11 22 33 12 13 23 (engineering shear): all six at once.
STRAIN = [1.0e-3, -0.4e-3, 0.7e-3, 0.9e-3, -1.3e-3, 0.5e-3]
# Numbers of .dat have 7 digits, those of the card 11.
DIGITS = 2e-6

CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]


def displacement(x):
    e11, e22, e33, g12, g13, g23 = STRAIN
    return (e11 * x[0] + g12 / 2 * x[1] + g13 / 2 * x[2],
            g12 / 2 * x[0] + e22 * x[1] + g23 / 2 * x[2],
            g13 / 2 * x[0] + g23 / 2 * x[1] + e33 * x[2])


def mesh(size):
    lines = ["*NODE"]
    for i, c in enumerate(CORNERS):
        lines.append("%d, %g, %g, %g" % (i + 1, *(a * b for a, b in zip(c, size))))
    return lines + ["*ELEMENT, TYPE=C3D8, ELSET=EALL", "1, 1, 2, 3, 4, 5, 6, 7, 8"]


def solve(name, lines):
    """The last table of numbers of the .dat file that CalculiX leaves."""
    with open(name + ".inp", "w") as f:
        f.write("\n".join(lines) + "\n")
    p = subprocess.run([ccx, name], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=60)
    rows = []
    if os.path.exists(name + ".dat"):
        for line in open(name + ".dat"):
            try:
                rows.append([float(w) for w in line.split()])
            except ValueError:
                pass
    rows = [r for r in rows if r]
    assert rows, p.stdout.decode()[-600:]
    return rows


def patch(card):
    """Stress 11 22 33 12 13 23 of a cube whose corners follow the strain."""
    lines = mesh((1, 1, 1)) + card + ["*SOLID SECTION, ELSET=EALL, MATERIAL=rve", "*STEP", "*STATIC", "*BOUNDARY"]
    for i, c in enumerate(CORNERS):
        for d, u in enumerate(displacement(c)):
            lines.append("%d, %d, %d, %.12g" % (i + 1, d + 1, d + 1, u))
    lines += ["*EL PRINT, ELSET=EALL", "S", "*END STEP"]
    return solve("patch", lines)[0][2:8]


def bar(card):
    """Displacements of the far face of a bar 5 x 1 x 1, pulled along 1 by unit stress."""
    lines = mesh((5, 1, 1)) + card + ["*SOLID SECTION, ELSET=EALL, MATERIAL=rve", "*BOUNDARY",
                                      "1, 1, 3", "4, 1", "5, 1", "8, 1", "2, 2, 3", "5, 2", "4, 3",
                                      "*STEP", "*STATIC", "*CLOAD"]
    lines += ["%d, 1, 0.25e-3" % i for i in (2, 3, 6, 7)]
    lines += ["*NSET, NSET=FAR", "2, 3, 6, 7", "*NODE PRINT, NSET=FAR", "U", "*END STEP"]
    return {int(r[0]): r[1:] for r in solve("bar", lines)}


number = failed = 0


def check(what, got, want, scale):
    global number, failed
    number += 1
    worst = max(abs(a - b) for a, b in zip(got, want)) / scale
    good = worst < DIGITS
    failed += not good
    print("%s %d - %s (off by %.1e)" % ("ok" if good else "not ok", number, what, worst))


def run():
    for name, text, kinds in (("isotropic", ISOTROPIC, ("isotropic", "orthotropic", "anisotropic")),
                              ("orthotropic", ORTHOTROPIC, ("orthotropic", "anisotropic")),
                              ("skew", SKEW, ("anisotropic",))):
        with open(name + ".yaml", "w") as f:
            f.write(text)
        subprocess.run([perihom, "run", name + ".yaml", "-q", "-o", name], check=True, stdout=subprocess.DEVNULL)
        result = json.load(open(name + "/result.json"))["effective"]
        order = [0, 1, 2, 5, 4, 3]
        C = [[result["stiffness"][i][j] for j in order] for i in order]
        stress = [sum(c * e for c, e in zip(row, STRAIN)) for row in C]
        for kind in kinds:
            words = [perihom, "export", name, "--to", "calculix", "--name", "rve", "--symmetry", kind]
            card = subprocess.run(words, check=True, stdout=subprocess.PIPE).stdout.decode().splitlines()
            check("%s material, %s card: stress" % (name, kind), patch(card), stress, max(map(abs, stress)))
            if name == "skew":
                continue  # its bar would shear against the supports
            S = result["compliance"]
            u = bar(card)
            check("%s material, %s card: bar" % (name, kind), u[7],
                  (5e-3 * S[0][0], 1e-3 * S[0][1], 1e-3 * S[0][2]), 5e-3 * S[0][0])


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    run()
print("1..%d" % number)
sys.exit(failed > 0)
