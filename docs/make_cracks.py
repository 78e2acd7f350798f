#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the figures of cracked cells again: docs/theory/cracks.md and docs/validation/cracks.md.

    PYTHONPATH=build/tools/python python3 docs/make_cracks.py [--only modes|microcracks|coalescing ...]

Needs python3-numpy and python3-matplotlib (Debian). Prints the numbers of the tables, writes the
figures to docs/pictures. Under a minute of processor time with OMP_NUM_THREADS=1."""
import argparse
import math
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import perihom

ROOT = Path(__file__).resolve().parent.parent
CASES, PICTURES = ROOT / "data/cases", ROOT / "docs/pictures"
ORANGE, SKY, GREEN, BLUE, RED = "#e69f00", "#56b4e9", "#009e73", "#0072b2", "#d55e00"
plt.rcParams.update({"savefig.dpi": 130, "font.size": 10, "axes.grid": True, "grid.color": "#dddddd",
                     "axes.spines.top": False, "axes.spines.right": False, "legend.frameon": False})


def save(figure, name):
    figure.tight_layout()
    figure.savefig(PICTURES / name)
    print(PICTURES / name)


# ---- fast modes beside a crack -----------------------------------------------------------

def alternation(u):
    """Root mean square of what of u2 alternates from node to node, (1 -3 3 -1)/8 along axis 1:
    1 for +-1, 0 for a parabola."""
    return math.sqrt((((u[:-3] - 3 * u[1:-2] + 3 * u[2:-1] - u[3:]) / 8) ** 2).mean())


def modes():
    n, length = 48, 0.5
    kinds = [("alpha 1e-5", "{spectral: 1e-5}"), ("alpha 0.001", "{spectral: 0.001}"), ("alpha 0.1 (default)", "auto"),
             ("alpha 0.5", "{spectral: 0.5}")]
    figure, axes = plt.subplots(2, len(kinds), figsize=(12, 6))
    exact = 0.6777  # elements with split nodes, extrapolated
    for k, (title, word) in enumerate(kinds):
        r = perihom.run(CASES / "growing-crack.yaml",
                        {"microstructure.nodes": [n, n], "model.stabilisation": word, "sequence": None,
                         "cracks.0.from": [0.25, 0.5], "cracks.0.to": [0.75, 0.5], "output.fields": True,
                         "solver.max_iterations": 20000})
        f = r.fields[1]
        u = np.asarray(f.displacement)[1].reshape(n, n)
        first, last = n // 4, 3 * n // 4
        inner = u[first + 1:last - 1]
        opening = (inner[:, n // 2] - inner[:, n // 2 - 1]).max()
        fast = alternation(u[first - 4:last + 4, n // 2:n // 2 + 3])
        ratio = r.stiffness[1, 1] / (2.0 / 0.91)
        print("| %s | %.2g | %.4f (%+.1f %%) | %s |" %
              (title, fast / opening, ratio, 100 * (ratio / exact - 1), max(r.iterations)))
        x = (np.arange(n) + 0.5) / n
        window = slice(n // 2 - 6, n // 2 + 6)
        ax = axes[0, k]
        ax.imshow(u[first - 3:n // 2, window].T, origin="lower", cmap="viridis", interpolation="nearest",
                  extent=(x[first - 3], x[n // 2], x[n // 2 - 6], x[n // 2 + 5]), aspect="auto")
        ax.set_title(title)
        ax.grid(False)
        ax = axes[1, k]
        for row, colour in ((n // 2, BLUE), (n // 2 + 1, SKY), (n // 2 + 2, GREEN)):
            ax.plot(x[first - 3:last + 3], u[first - 3:last + 3, row], ".-", color=colour, ms=4, lw=1,
                    label="row %d above the crack" % (row - n // 2 + 1))
        ax.set_ylim(0.45, 1.05)
        ax.set_xlabel("x1")
    axes[0, 0].set_ylabel("u2 at the left tip")
    axes[1, 0].set_ylabel("u2 for unit strain 22")
    axes[1, 0].legend(fontsize=8)
    save(figure, "crack-modes.png")


# ---- random microcracks ------------------------------------------------------------------

def schemes(b, rho):
    """Modulus over that without cracks, where a dilute crack density adds b to the compliance."""
    return {"non-interacting, Mori-Tanaka": 1 / (1 + b * rho), "differential": np.exp(-b * rho),
            "self-consistent": np.maximum(1 - b * rho, 0)}


def aligned_differential(rho, nu, steps=2000):
    """E2 of aligned cracks one after the other in the orthotropic medium that they have made:
    opening compliance pi/2 sqrt(S11) sqrt(2 sqrt(S11 S22) + 2 S12 + S66) of a tension along 2."""
    s11, s12, s66 = 1.0, -nu, 2 * (1 + nu)
    s22, out, at = 1.0, [], 0.0
    for target in rho:
        d = (target - at) / steps
        for _ in range(steps if d > 0 else 0):
            root = math.sqrt(2 * math.sqrt(s11 * s22) + 2 * s12 + s66)
            n, t = math.pi * math.sqrt(s22) * root, math.pi * math.sqrt(s11) * root
            s22, s66 = s22 + d * n, s66 + d * t
        at = target
        out.append(1 / s22)
    return np.array(out)


def aligned_consistent(rho, nu):
    """The same, all in the medium that they make together."""
    out, s22, s66 = [], 1.0, 2 * (1 + nu)
    for target in rho:
        for _ in range(4000):
            root = math.sqrt(2 * math.sqrt(s22) - 2 * nu + s66)
            new22, new66 = 1 + target * math.pi * math.sqrt(s22) * root, 2 * (1 + nu) + target * math.pi * root
            s22, s66 = 0.5 * (s22 + new22), 0.5 * (s66 + new66)
        out.append(1 / s22)
    return np.array(out)


def microcracks():
    nu, densities = 0.3, [0.01, 0.02, 0.05, 0.1, 0.15, 0.2]
    fine = np.linspace(0, 0.2, 41)
    figure, axes = plt.subplots(1, 2, figsize=(11, 4.4), sharey=True)
    for ax, kind in zip(axes, ("aligned", "random")):
        b = 2 * math.pi if kind == "aligned" else math.pi
        lines = schemes(b, fine)
        if kind == "aligned":
            lines["differential"] = aligned_differential(fine, nu)
            lines["self-consistent"] = aligned_consistent(fine, nu)
        for (name, y), style in zip(lines.items(), ("-", "--", ":")):
            ax.plot(fine, y, style, color="black", lw=1.2, label=name)
        for tips, colour, mark in ((0.0, ORANGE, "s"), (0.42, BLUE, "o")):
            got = []
            for realisation in (0, 1):
                sets = {"microstructure.nodes": [150, 150], "model.crack_tips": tips or None,
                        "microstructure.realisation": realisation, "sequence": {"density": densities},
                        "cracks.0.random": {"density": 0.2, "length": 0.1, "orientation": kind}}
                document = perihom.run(CASES / "microcracks.yaml", sets).to_dict()
                steps = document["effective"]["damage"]["steps"]
                got.append([(s["density"], s["psi"][1] if kind == "aligned" else sum(s["psi"]) / 2, s["psi"][0],
                             s["anisotropy_index"]) for s in steps])
            got = np.array(got)
            mean = got.mean(axis=0)
            ax.plot(got[:, :, 0].T, got[:, :, 1].T, mark, color=colour, ms=4, mfc="none")
            ax.plot(mean[:, 0], mean[:, 1], mark, color=colour, label="cells" + (", crack_tips 0.42" if tips else ""))
            dilute = 1 / (1 + b * mean[:, 0])
            for row, d in zip(mean, dilute):
                print("| %s | %g | %.3f | %.4f | %.4f (%+.1f %%) | %.4f | %.4f |" %
                      (kind, tips, row[0], d, row[1], 100 * (row[1] / d - 1), row[2], row[3]), flush=True)
        ax.set_title(kind + (": E2/E2(0)" if kind == "aligned" else ": mean of E1 and E2 over E(0)"))
        ax.set_xlabel("crack density")
        ax.set_ylim(0, 1)
        ax.legend(fontsize=8)
    save(figure, "microcracks.png")


# ---- two cracks that become one ----------------------------------------------------------

# Elements with split nodes, extrapolated from 64 and 128 (tests/verify/test_cracks.c).
ELEMENTS = {0.125: (0.94645, 0.00083), 0.1875: (0.87885, 0.00463), 0.25: (0.67769, 0.04273)}


def coalescing():
    figure, axes = plt.subplots(1, 2, figsize=(11, 4))
    for n, colour in ((80, ORANGE), (160, BLUE)):
        steps = perihom.run(CASES / "merging-cracks.yaml",
                            {"microstructure.nodes": [n, n]}).to_dict()["effective"]["damage"]
        c0 = steps["pristine"][1][1]
        x = [s["crack_length"] for s in steps["steps"]]
        axes[0].plot(x, [s["stiffness"][1][1] / c0 for s in steps["steps"]], ".-", color=colour, label="%d x %d" % (n, n))
        axes[1].plot(x, [s["anisotropy_index"] for s in steps["steps"]], ".-", color=colour, label="%d x %d" % (n, n))
    for k, name in enumerate(("C22/C22(0)", "anisotropy index")):
        axes[k].plot(list(ELEMENTS), [v[k] for v in ELEMENTS.values()], "kx", label="elements, limit")
        axes[k].axvline(0.25, color="#999999", lw=0.8)
        axes[k].set_xlabel("length of each crack; the tips meet at 0.25")
        axes[k].set_ylabel(name)
        axes[k].legend()
    axes[1].set_ylim(0, 0.3)
    save(figure, "merging-cracks.png")


def main():
    parts = {"modes": modes, "microcracks": microcracks, "coalescing": coalescing}
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", choices=list(parts), default=list(parts))
    for name in parser.parse_args().only:
        parts[name]()


main()
