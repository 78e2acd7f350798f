#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A beam of explicitly resolved cells against the homogenised beam, docs/validation/beam.md.

Plane strain, clamped at one end, the other moved across; every cell a stiff square in a soft
matrix. Both beams in sfepy; the stiffness from perihom, with the same elements (model local).
Prints the table and writes docs/pictures/beam.svg.

usage: PYTHONPATH=build/tools/python /usr/bin/python3 docs/make_beam.py
"""
import os
import sys

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tests", "consumers"))
from beam import Block
import perihom

RATIO = 4         # length over height
ELEMENTS = 6      # of a cell, each way
SOFT, STIFF = (1.0, 0.3), (20.0, 0.2)


def pattern():
    inside = slice(1, ELEMENTS - 1)
    phase = np.zeros((ELEMENTS, ELEMENTS), int)
    phase[inside, inside] = 1
    return phase


def plane_strain(E, nu):
    return E / ((1 + nu) * (1 - 2 * nu)) * np.array([[1 - nu, nu, 0], [nu, 1 - nu, 0], [0, 0, 0.5 - nu]])


def reaction(block):
    strain = block.solve(1.0)
    stress = np.einsum("...ij,...j->...i", block.stiffness, strain)
    return block.work(stress, strain)


def resolved(cells, through=False):
    """The beam of `cells` cells through its thickness; through: its surfaces cut the squares."""
    n = cells * ELEMENTS
    block = Block(RATIO, 1, RATIO * n, n, 1)
    h = 1.0 / n
    index = np.floor(block.points / h + [0, n / 2 + (ELEMENTS // 2 if through else 0)]).astype(int) % ELEMENTS
    phase = pattern()[index[:, 0], index[:, 1]]
    block.stiffness = np.where(phase[:, None, None] == 1, plane_strain(*STIFF), plane_strain(*SOFT))
    return reaction(block)


def homogenised():
    micro = perihom.Microstructure([perihom.Material.isotropic("soft", *SOFT), perihom.Material.isotropic("stiff", *STIFF)],
                                   pattern(), plane="strain")
    block = Block(RATIO, 1, 32 * RATIO, 32, 2)
    block.stiffness = perihom.homogenise(micro, model="local", interface="node_centre", tolerance=1e-9, threads=1).stiffness
    return reaction(block)


def errors(numbers, through=False):
    """(cells through the thickness, relative error of the homogenised reaction)."""
    smooth = homogenised()
    return [(n, smooth / resolved(n, through) - 1) for n in numbers]


def figure(found, cut, path):
    import matplotlib
    matplotlib.use("svg")
    import matplotlib.pyplot as plt
    plt.rcParams["svg.hashsalt"] = "perihom"
    n, e = np.array(found).T
    fig, axes = plt.subplots(figsize=(5.2, 3.6))
    axes.loglog(n, e, "o-", color="#0072b2", label="surfaces in the matrix")
    axes.loglog(n, [abs(e) for _, e in cut], "s-", color="#d55e00", label="surfaces through the squares")
    axes.loglog(n, e[-1] * n[-1] / n, "--", color="#888888", label="first order")
    axes.set_xticks(n, ["%d" % x for x in n])
    axes.minorticks_off()
    axes.set_xlabel("cells through the thickness")
    axes.set_ylabel("error of the reaction, absolute")
    axes.grid(True, color="#dddddd")
    axes.legend(frameon=False)
    fig.tight_layout()
    fig.savefig(path, metadata={"Date": None})


if __name__ == "__main__":
    found = errors((1, 2, 4, 8, 16))
    cut = errors((1, 2, 4, 8, 16), through=True)
    for (n, e), (_, c) in zip(found, cut):
        print("| %d | %+.2f %% | %+.2f %% |" % (n, 100 * e, 100 * c))
    figure(found, cut, os.path.join(os.path.dirname(os.path.abspath(__file__)), "pictures", "beam.svg"))
