#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""sfepy solves macroscale problems with perihom at its integration points. Prints TAP.

Plane strain; beams clamped at one end, the other end moved across.
"""
import os
import sys

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
try:
    from beam import Block, EssentialBC
except ImportError as missing:
    print("1..0 # SKIP %s" % missing)
    sys.exit(77)
import perihom

number = failed = 0


def check(what, good):
    global number, failed
    number += 1
    failed += not good
    print("%s %d - %s" % ("ok" if good else "not ok", number, what), flush=True)


def cell(materials, n, inside):
    phase = np.zeros((n, n), int)
    phase[(n - inside) // 2:(n + inside) // 2, (n - inside) // 2:(n + inside) // 2] = 1
    return perihom.Microstructure(materials, phase, plane="strain")


# ---- a viscoelastic beam ------------------------------------------------------------------


def relaxing_beam(beam, series, times):
    """Reaction of the tip, moved by 1 at t = 0 and held, at 0 and at every time: the step is
    T : deps + (stress of no strain) in equilibrium, T the tangent of the material point."""
    point = perihom.MaterialPoint(series)
    shape, _ = elastic_beam(beam, series.instantaneous)  # work of this strain: reaction times 1
    state = point.state(len(beam.points))
    reaction, now = [], 0.0
    for t in [0.0] + list(times):
        rest, beam.stiffness = point.update(state.copy(), np.zeros((len(state), 3)), t - now)
        beam.stress = rest
        de = beam.solve(1.0 if t == 0 else 0.0)
        stress, _ = point.update(state, de, t - now)
        reaction.append(beam.work(stress, shape))
        now = t
    beam.stress = None
    return np.array(reaction)


def elastic_beam(beam, D):
    beam.stiffness = D
    strain = beam.solve(1.0)
    return strain, beam.work(strain @ D, strain)


def carson(series, s):
    """C(s) of a series."""
    x = s * series.time
    return series.equilibrium + np.tensordot(x / (1 + x), series.stiffness, 1)


def carson_of_curve(t, r, s):
    """s times the Laplace transform of the curve that is linear between its points."""
    t = np.concatenate([[0.0], t])
    slope = np.diff(r) / np.diff(t)
    return r[0] + np.sum(slope * (np.exp(-s * t[:-1]) - np.exp(-s * t[1:]))) / s


def viscoelastic():
    resin = perihom.Material.viscoelastic("resin", bulk=(4.0, [(3.0, 1.0)]), shear=(0.1, [(0.2, 1.0), (5.0, 0.8)]))
    fibre = perihom.Material.isotropic("fibre", 30, 0.2)
    series = perihom.relaxation(cell([resin, fibre], 12, 6)).series
    beam = Block(6, 1, 12, 3, 2)
    errors = []
    for steps in (40, 80):
        times = np.geomspace(1e-3, 1e4, steps)
        r = relaxing_beam(beam, series, times)
        worst = 0
        for s in (0.01, 0.1, 0.5, 2.0, 20.0):
            exact = elastic_beam(beam, carson(series, s))[1]
            worst = max(worst, abs(carson_of_curve(times, r, s) / exact - 1))
        errors.append(worst)
    first, last = (elastic_beam(beam, C)[1] for C in (series.instantaneous, series.equilibrium))
    print("# %d terms, reaction %.5g -> %.5g; off the correspondence principle by %.1e (40 steps), %.1e (80)"
          % (len(series), r[0], r[-1], *errors))
    # Strain is linear over a step: an error of second order, 4 at half the step.
    check("relaxation of a beam: correspondence principle, second order in the step",
          errors[1] < 2e-3 and 3 < errors[0] / errors[1] < 5)
    # No step before the first one; after 1e4 the slowest term (5) is gone.
    check("relaxation of a beam: both ends are elastic", abs(r[0] / first - 1) < 1e-9 and abs(r[-1] / last - 1) < 1e-5)


# ---- FE2 ----------------------------------------------------------------------------------


class Graded:
    """Stiffness of fibres whose radius varies along x: the RVE of every integration point is
    solved by perihom, once for each fraction."""

    def __init__(self, n=16):
        self.n, self.cache, self.asked = n, {}, 0

    def fraction(self, x):
        return 0.1 + 0.4 * x / 4.0

    def stiffness(self, x):
        self.asked += 1
        f = round(self.fraction(x), 9)
        if f not in self.cache:
            case = perihom.Case.from_dict({
                "perihom": 1, "title": "graded", "units": {"length": "mm", "stress": "GPa", "time": "s"},
                "materials": {"m": {"E": 3.0, "nu": 0.35}, "f": {"E": 70.0, "nu": 0.2}},
                "microstructure": {"dimension": 2, "plane": "strain", "size": [1, 1], "nodes": [self.n, self.n],
                                   "matrix": "m", "inclusions": [{"shape": "disk", "centre": [0.5, 0.5],
                                                                  "fraction": f, "material": "f"}]}})
            self.cache[f] = case.run(threads=1).stiffness
        return self.cache[f]


def fe2():
    """Pushed along x with no way aside: stress 11 is constant and its compliance the mean of
    1/C11 over x, here by Gauss points of a rule of high order."""
    def pushed(bar, move):
        return [EssentialBC("side", bar.all, {"u.1": 0.0}), EssentialBC("left", bar.left, {"u.0": 0.0}),
                EssentialBC("right", bar.right, {"u.0": move})]

    graded, bar = Graded(), Block(4, 1, 8, 1, 2, pushed)
    bar.stiffness = np.array([graded.stiffness(x) for x in bar.points[:, 0]])
    calls = len(graded.cache)
    strain = bar.solve(1.0)
    stress = np.einsum("nij,nj->ni", bar.stiffness, strain)
    x, w = np.polynomial.legendre.leggauss(20)
    exact = 1.0 / sum(2 * b / graded.stiffness(2 * a + 2)[0, 0] for a, b in zip(x, w))
    print("# %d RVEs for %d integration points; stress %.8g, exact %.8g"
          % (calls, len(bar.points), bar.work(stress, strain), exact))
    check("FE2: an RVE for every fraction, no more", calls == 24 and len(bar.points) == 72)
    # Quadratic elements of a smooth grading: energy of order h^4, (1/8)^4 = 2e-4 of its variation.
    check("FE2: graded bar against the exact stress", abs(bar.work(stress, strain) / exact - 1) < 1e-4)


# ---- resolved cells -----------------------------------------------------------------------


def scale_ratio():
    sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "docs"))
    from make_beam import errors
    found = errors((1, 2, 4))
    print("# cells through the thickness, error of the tip stiffness: %s" % ["%d: %+.4f" % pair for pair in found])
    # What is left is a boundary layer of one cell: first order. 4 cells have less than half of 2.
    check("a beam of resolved cells tends to the homogenised one",
          all(0 < after < before / 2 for (_, before), (_, after) in zip(found, found[1:])) and found[2][1] < 0.05)


viscoelastic()
fe2()
scale_ratio()
print("1..%d" % number)
sys.exit(failed > 0)
