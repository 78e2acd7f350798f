#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Macroscale problems with an RVE at every integration point that has a history: a beam that
relaxes, a bar and a beam whose fibres come loose. The macroscale is sfepy, or, where it is
missing, the few elements of plain_block.py. Prints TAP.
"""
import os
import sys

import numpy as np

import perihom

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
try:
    from beam import Block, EssentialBC
    macroscale = "sfepy"
except ImportError:
    from plain_block import Block
    macroscale = "plain elements"

number = failed = 0


def check(what, good):
    global number, failed
    number += 1
    failed += not good
    print("%s %d - %s" % ("ok" if good else "not ok", number, what), flush=True)


def cell(materials, n, inside, plane):
    phase = np.zeros((n, n), int)
    phase[(n - inside) // 2:(n + inside) // 2, (n - inside) // 2:(n + inside) // 2] = 1
    return perihom.Microstructure(materials, phase, plane=plane)


def pulled(block, move):
    """Along x, nothing moves across: the strain is (e, 0, 0) where all points are alike."""
    if macroscale == "sfepy":
        return [EssentialBC("side", block.all, {"u.1": 0.0}), EssentialBC("left", block.left, {"u.0": 0.0}),
                EssentialBC("right", block.right, {"u.0": move})]
    return [(block.all, 1, 0.0), (block.left, 0, 0.0), (block.right, 0, move)]


class Point:
    """A material point with the calls of perihom.Points."""

    def __init__(self, law, points):
        self.law, self.state = law, law.state(points)

    def update(self, de, dt):
        self.tried = self.state.copy()
        stress, tangent = self.law.update(self.tried, de, dt)
        return stress, np.broadcast_to(tangent, (len(de), 3, 3))

    def accept(self):
        self.state = self.tried


def step(block, at, move, dt, most=25, tolerance=1e-9):
    """One increment of a macroscale Newton iteration: T : d(deps) + stress in equilibrium."""
    de = np.zeros((len(block.points), 3))
    for iteration in range(most):
        block.stress, block.stiffness = at.update(de, dt)
        correction = block.solve(move if iteration == 0 else 0.0)
        de = de + correction
        if iteration and np.abs(correction).max() <= tolerance * np.abs(de).max():
            break
    else:
        raise AssertionError("no equilibrium in %d iterations" % most)
    stress, _ = at.update(de, dt)
    at.accept()
    return stress, de, iteration


# ---- a beam that relaxes ------------------------------------------------------------------


def bend(block, at, times, shape):
    """Moment of the tip against `shape` at the end of every step: moved in the first, then held."""
    out, most = [], 0
    for k, dt in enumerate(times):
        stress, _, iterations = step(block, at, 1.0 if k == 0 else 0.0, dt)
        out.append(block.work(stress, shape))
        most = max(most, iterations)
    return np.array(out), most


def viscoelastic():
    resin = perihom.Material.viscoelastic("resin", bulk=(4.0, [(3.0, 1.0)]), shear=(0.1, [(0.2, 1.0), (5.0, 0.8)]))
    micro = cell([resin, perihom.Material.isotropic("fibre", 30, 0.2)], 8, 4, "strain")
    law = perihom.MaterialPoint(perihom.relaxation(micro, model="local", tolerance=1e-8))
    block = Block(4, 1, 4, 2, 1)
    block.stiffness = law.effective.stiffness
    shape = block.solve(1.0)
    rve, off = perihom.FE2(micro, model="local", tolerance=1e-8), []
    for n in (6, 12):
        times = np.diff(np.concatenate([[0], np.geomspace(0.05, 10, 6)]))
        times = np.repeat(times, n // 6) / (n // 6)
        want, _ = bend(block, Point(law, len(block.points)), times, shape)
        before = rve.counts["solves"]
        at = rve.points(len(block.points))
        got, iterations = bend(block, at, times, shape)
        off.append(np.abs(got / want - 1).max())
        solves = rve.counts["solves"] - before
        # n steps but the first, from rest, ask each RVE once, and each length of step for three
        # unit strains (two where symmetry makes a load nothing); a macroscale iteration asks nothing.
        check("a beam of %d points that relax, %d steps: %d solves, %d corrections"
              % (len(at), n, solves, iterations), solves <= (n - 1) * len(at) + 3 * 12 and iterations <= 2)
    print("# %s: off the material point by %.1e (6 steps), %.1e (12)" % (macroscale, *off))
    # Strains inside the RVE are straight over a step, second order; half the step, a quarter.
    check("and is the beam of the material point, to the second order", off[1] < 5e-3 and off[0] / off[1] > 2.5)


# ---- fibres that come loose ---------------------------------------------------------------


def brittle_rve(n, scatter):
    """scatter: Weibull shape, 0 is none."""
    a, b = (perihom.Material.isotropic(name, E, 1 / 3) for name, E in (("matrix", 1.0), ("fibre", 10.0)))
    return perihom.FE2(cell([a, b], n, n // 2, "stress"), model="bond", horizon=2.0,
                       strengths={"matrix": {"critical_stretch": 0.02, "weibull": scatter}, "fibre": {"unbreakable": True}},
                       interphase={"critical_stretch": 0.01, "weibull": scatter}, seed=1)


def record(rve, direction, to, steps):
    """Damage law of a straight path: d falls with the energy, the steps are its knots."""
    alone, e = rve.points(1), np.array(direction)
    stiffness = [alone.update(np.zeros((1, 3)))[1][0]]
    for _ in range(steps):
        stiffness.append(alone.update(e[None] * to / steps)[1][0])
        alone.accept()
    damage = [1 - e @ C @ e / (e @ stiffness[0] @ e) for C in stiffness]
    load = np.linspace(0, to, steps + 1)
    kept = [0] + [k for k in range(1, steps + 1) if damage[k] > damage[k - 1] + 1e-9]
    return perihom.DamageLaw(e, [damage[k] for k in kept], [stiffness[k] for k in kept],
                             [load[k - 1] for k in kept[1:]], [load[k] for k in kept[1:]])


def bar():
    """All points alike: each is the RVE under the strain of the bar, and so is the material
    point of the law that was recorded along it."""
    rve, block = brittle_rve(8, 0.0), Block(2, 1, 2, 1, 1, pulled)
    steps, to = 14, 0.014  # past the peak: all points alike is an equilibrium, and the first that Newton finds
    law = record(rve, [1, 0, 0], to, steps)
    at, alone = rve.points(len(block.points)), rve.points(1)
    point, other = Point(perihom.MaterialPoint(law), len(block.points)), Block(2, 1, 2, 1, 1, pulled)
    off, law_off = 0.0, 0.0
    for k in range(steps):
        stress, _, _ = step(block, at, 2 * to / steps, 1.0)
        want, _ = alone.update(np.array([[to / steps, 0, 0]]), 1.0)
        alone.accept()
        law_stress, _, _ = step(other, point, 2 * to / steps, 1.0)
        off = max(off, np.abs(stress - want).max() / np.abs(want).max())
        law_off = max(law_off, np.abs(law_stress - want).max() / np.abs(want).max())
    print("# bar: %d bonds broken in each point, %.0f %% of the stiffness lost; off the RVE alone by %.1e, its law by %.1e"
          % (at.broken_bonds[0], 100 * law.damage[-1], off, law_off))
    # Strains of the bar differ by its solver's round-off; events are where they are.
    check("a bar that fails is its RVE", off < 1e-6 and at.broken_bonds[0] > 20 and np.ptp(at.broken_bonds) == 0)
    # At the knots of the law the stress is that of the record, to the RVE's tolerance of 1e-6.
    check("and so is the material point of its damage law", law_off < 1e-4)


def failing_beam():
    """Points of different histories: where nothing breaks nothing is solved; what was broken
    stays so when the beam is let go."""
    rve, block = brittle_rve(6, 2.0), Block(3, 1, 3, 2, 1)
    at, reaction = rve.points(len(block.points)), []
    _, first = at.update(np.zeros((len(at), 3)))
    block.stiffness = first
    shape = block.solve(1.0)
    start = rve.counts["solves"]
    solves = []
    for move in (0.002, 0.018, 0.02):
        stress, _, _ = step(block, at, move, 1.0, tolerance=1e-5)
        reaction.append(block.work(stress, shape))
        solves.append(rve.counts["solves"] - start)
    broken, lost, stiffness, events = at.broken_bonds, at.dissipated, np.array(block.stiffness), rve.counts["events"]
    stress, _, _ = step(block, at, -0.04, 1.0)
    hit = broken > 0
    print("# %s: %d of %d points have broken bonds (%d), %d solves; reaction %.4g, %.4g without"
          % (macroscale, hit.sum(), len(at), broken.sum(), solves[-1], reaction[-1], 20 * reaction[0]))
    check("a beam: the first small step is elastic and solves nothing", solves[0] == 0 and reaction[0] > 0)
    check("bonds break in some points, and take energy and stiffness there alone",
          0 < hit.sum() < len(at) and reaction[-1] < 19.9 * reaction[0] and (lost[hit] > 0).all()
          and (lost[~hit] == 0).all() and np.array_equal(stiffness[~hit], first[~hit]))
    # Stress of the Newton iteration's tolerance, held against what it was.
    check("let go, it is at rest without another event",
          np.abs(stress).max() < 1e-6 and rve.counts["events"] == events and (at.broken_bonds == broken).all())


viscoelastic()
bar()
failing_beam()
print("1..%d" % number)
sys.exit(failed > 0)
