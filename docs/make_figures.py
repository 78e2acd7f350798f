#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the figures and tables of the manual again, from the program.

    python3 docs/make_figures.py [--perihom build/tools/perihom] [--only NAME ...] [--list]

Needs python3-matplotlib (Debian). Figures go to docs/pictures; a table replaces what stands in
its page between `<!-- table: NAME -->` and `<!-- end -->`. Every number comes from a run of the
program or from a file of data/reference. Answers are kept in --cache, by case text, overrides and
version, so that only what changed is computed again; delete the folder to start afresh.
Everything from an empty cache: about two minutes of processor time."""
import argparse
import csv
import hashlib
import json
import math
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
PICTURES = ROOT / "docs/pictures"
ARGS = None

# Okabe and Ito's colours, told apart by everyone; each with its own marker as well.
BLACK, ORANGE, SKY, GREEN, YELLOW, BLUE, RED, PINK = (
    "#000000", "#e69f00", "#56b4e9", "#009e73", "#f0e442", "#0072b2", "#d55e00", "#cc79a7")
plt.rcParams.update({
    "figure.dpi": 100, "savefig.dpi": 160, "font.size": 11, "axes.grid": True,
    "grid.color": "#dddddd", "axes.spines.top": False, "axes.spines.right": False,
    "legend.frameon": False, "lines.linewidth": 1.6, "lines.markersize": 5,
    "axes.titlesize": 11, "svg.hashsalt": "perihom"})


# ---- runs ------------------------------------------------------------------------------

def perihom(verb, case, sets=()):
    """The JSON document of one call. `sets`: strings key=value."""
    text = (ROOT / "data/cases" / case).read_text()
    key = hashlib.sha1(json.dumps([ARGS.version, verb, text, list(sets)]).encode()).hexdigest()
    kept = Path(ARGS.cache) / (key + ".json")
    if kept.exists():
        return json.loads(kept.read_text())
    command = [ARGS.perihom, verb, str(ROOT / "data/cases" / case)]
    for s in sets:
        command += ["--set", s]
    with tempfile.TemporaryDirectory() as folder:
        if verb == "run":
            command += ["-q", "-j", "1", "-o", folder + "/result"]
        got = subprocess.run(command + ["--json"], capture_output=True, text=True)
    if got.returncode:
        return {"failed": got.returncode, "why": got.stderr.strip()}
    kept.parent.mkdir(parents=True, exist_ok=True)
    kept.write_text(got.stdout)
    return json.loads(got.stdout)


def runs(jobs, verb="run"):
    """Many calls, two at a time. jobs: {name: (case, sets)} -> {name: document}."""
    with ThreadPoolExecutor(ARGS.jobs) as pool:
        waiting = {k: pool.submit(perihom, verb, *v) for k, v in jobs.items()}
        done = {}
        for i, (k, w) in enumerate(waiting.items()):
            done[k] = w.result()
            if sys.stderr.isatty():
                print(f"\r{i + 1}/{len(jobs)} ", end="", file=sys.stderr)
    return done


def grid(n, m=None):
    return f"microstructure.nodes=[{n},{m or n}]"


def constants(result):
    return result["effective"]["engineering"]


def stiffness(result, i, j):
    return result["effective"]["stiffness"][i][j]


def reference(name):
    with open(ROOT / "data/reference" / name) as f:
        return list(csv.DictReader(line for line in f if not line.startswith("#")))


# ---- pages -----------------------------------------------------------------------------

def table(page, name, head, rows):
    """Replace a table of a page. A page without the mark is an error: nothing is lost."""
    path = ROOT / "docs" / page
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    lines += ["| " + " | ".join(str(c) for c in r) + " |" for r in rows]
    mark = f"<!-- table: {name} -->"
    text, n = re.subn(re.escape(mark) + r"\n.*?<!-- end -->",
                      lambda _: mark + "\n" + "\n".join(lines) + "\n<!-- end -->",
                      path.read_text(), count=1, flags=re.S)
    if n != 1:
        sys.exit(f"{page}: no {mark}")
    path.write_text(text)


def save(figure, name):
    PICTURES.mkdir(exist_ok=True)
    figure.savefig(PICTURES / name, metadata={"Software": None})
    plt.close(figure)


def signed(value, ref, digits=3):
    return f"{100 * (value / ref - 1):+.{digits}f}"


# ---- exact antiplane shear of a square array of disks --------------------------------------

def rayleigh(fraction, contrast, orders=40):
    """G/G_matrix of a square array of disks under antiplane shear, by Rayleigh's series
    [Perrins1979]: A_l = E d_l1 - sum_n C(l+n-1, l) S_{l+n} B_n over odd l, n."""
    a2 = fraction / math.pi
    odd = range(1, 2 * orders, 2)
    size = 400
    i, j = np.meshgrid(np.arange(-size, size + 1), np.arange(-size, size + 1))
    z = (i + 1j * j).astype(complex)
    z[size, size] = 1  # the origin itself does not count
    sums = {2: math.pi}
    for m in range(4, 4 * orders + 2, 2):
        sums[m] = float(np.sum(z ** -float(m)).real) - 1 if m % 4 == 0 else 0.0
    M = np.zeros((orders, orders))
    for r, l in enumerate(odd):
        for c, n in enumerate(odd):
            # unknowns b_n = B_n / a^n, equations times a^l
            M[r, c] = math.comb(l + n - 1, l) * sums[l + n] * a2 ** ((l + n) / 2)
        M[r, r] += (1 + contrast) / (1 - contrast)
    right = np.zeros(orders)
    right[0] = math.sqrt(a2)
    return 1 - 2 * math.pi * math.sqrt(a2) * np.linalg.solve(M, right)[0]


FIGURES = {}


def figure(f):
    FIGURES[f.__name__.replace("_", "-")] = f
    return f


# ---- validation: boron/aluminium -------------------------------------------------------

BA = "boron-aluminium.yaml"
BA_NAMES = {"E1": "E across", "E3": "E axial", "nu31": "nu axial-across",
            "nu12": "nu across", "G13": "G axial", "G12": "G across"}
BA_MODELS = {
    "stress points, composite": ("model.points=stress", "composite", BLUE, "o", "-"),
    "nodes, horizon 2, composite": ("model.points=nodes", "composite", RED, "s", "-"),
    "stress points, node centre": ("model.points=stress", "node_centre", SKY, "o", "--"),
    "nodes, horizon 2, node centre": ("model.points=nodes", "node_centre", ORANGE, "s", "--"),
    "finite elements (local), composite": ("model.kind=local", "composite", GREEN, "^", "-")}
BA_GRIDS = (32, 64, 128, 256)


def ba_sets(model, n):
    points, interface = BA_MODELS[model][:2]
    horizon = "model.horizon=2" if "nodes" in points else "model.horizon="
    return [grid(n), points, horizon, f"microstructure.interface={interface}"]


@figure
def boron_aluminium_convergence():
    exact = {r["constant"]: float(r["value"]) for r in reference("boron-aluminium-exact.csv")
             if r["kinematics"] == "generalised_strain"}
    got = runs({(m, n): (BA, ba_sets(m, n)) for m in BA_MODELS for n in BA_GRIDS})
    fig, axes = plt.subplots(2, 3, figsize=(9.6, 6.6), sharex=True, sharey=True)
    for ax, (c, name) in zip(axes.flat, BA_NAMES.items()):
        for m, (_, _, colour, mark, line) in BA_MODELS.items():
            error = [100 * abs(constants(got[m, n])[c] / exact[c] - 1) for n in BA_GRIDS]
            ax.loglog(BA_GRIDS, error, line, marker=mark, color=colour, label=m)
        n = np.array([32.0, 256.0])
        ax.loglog(n, 0.6 * 32 / n, ":", color="#888888", lw=1)
        ax.set_title(f"{name} ({c})")
        ax.set_xticks(BA_GRIDS, [str(n) for n in BA_GRIDS])
        ax.minorticks_off()
        ax.set_ylim(1e-4, 4)
    axes[0, 1].annotate("order 1", (90, 0.28), color="#666666", fontsize=9)
    for ax in axes[:, 0]:
        ax.set_ylabel("error [%]")
    for ax in axes[1]:
        ax.set_xlabel("nodes along an edge")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    fig.legend(handles, labels, loc="lower center", ncol=2)
    fig.tight_layout(rect=(0, 0.12, 1, 1))
    save(fig, "boron-aluminium-convergence.png")
    rows = []
    for m in BA_MODELS:
        for n in BA_GRIDS:
            e = constants(got[m, n])
            worst = max(abs(e[c] / exact[c] - 1) for c in BA_NAMES)
            rows.append([m, f"{n}²"] + [f"{e[c]:.4f}" if c.startswith("nu") else f"{e[c]:.3f}"
                                        for c in BA_NAMES]
                        + [f"{100 * worst:.2f}", max(got[m, n]["solver"]["iterations"])])
    rows.append(["**exact**", ""] + [f"**{exact[c]:g}**" for c in BA_NAMES] + ["", ""])
    table("validation/boron-aluminium.md", "convergence",
          ["model", "nodes"] + [f"{n} {c}" for c, n in BA_NAMES.items()]
          + ["worst error, %", "iterations"], rows)


@figure
def boron_aluminium_published():
    plane = "boron-aluminium-plane-strain.yaml"
    jobs = {("g", "periodic"): (BA, ba_sets("stress points, composite", 256))}
    for k in ("strain", "stress"):
        for c in ("periodic", "linear_displacement"):
            jobs[k, c] = (plane, [grid(256), f"microstructure.plane={k}", f"constraint={c}"])
    got = {k: constants(v) for k, v in runs(jobs).items()}
    rows = [[r["row"], r["E_GPa"], r["nu12"], r["mu12_GPa"], ""]
            for r in reference("boron-aluminium-published.csv")]
    g = got["g", "periodic"]
    rows.append(["**perihom**, fibre composite: E1, nu31, G13", f"{g['E1']:.2f}",
                 f"{g['nu31']:.4f}", f"{g['G13']:.2f}", "143.956, 0.19456, 54.378"])
    rows.append(["**perihom**, fibre composite, in the plane: E1, nu12, G12", f"{g['E1']:.2f}",
                 f"{g['nu12']:.4f}", f"{g['G12']:.2f}", "143.956, 0.25513, 45.824"])
    exact = {"strain": "147.693, 0.28772, 45.824", "stress": "133.811, 0.20879, 45.634"}
    for k in ("stress", "strain"):
        for c, word in (("periodic", "periodic"), ("linear_displacement", "u = eps x")):
            e = got[k, c]
            rows.append([f"**perihom**, plane {k}, {word}: E1, nu12, G12", f"{e['E1']:.2f}",
                         f"{e['nu12']:.4f}", f"{e['G12']:.2f}",
                         exact[k] if c == "periodic" else ""])
    table("validation/boron-aluminium.md", "published",
          ["row", "E, GPa", "nu", "mu, GPa", "exact"], rows)


# ---- validation: glass/epoxy -----------------------------------------------------------

GE = "glass-epoxy-plane-strain.yaml"
GE_FRACTIONS = [0.05 * i for i in range(16)]
ESTIMATES = {"dilute": (PINK, (0, (1, 1))), "mori_tanaka": (GREEN, "--"),
             "self_consistent": (ORANGE, "-."), "differential": (SKY, "--"),
             "generalised_self_consistent": (RED, (0, (4, 1, 1, 1, 1, 1)))}
BOUNDS = ("voigt", "reuss", "hashin_shtrikman_lower", "hashin_shtrikman_upper")
ENTRIES = {"C11": (0, 0), "C12": (0, 1), "C66": (2, 2)}


def ge_inclusion(c):
    if c < 1e-9:
        return "microstructure.inclusions="
    return f"microstructure.inclusions.0.fraction={c:.4g}"


def ge_overlap(radius):
    """Beyond pi/4 the disk meets its images; what it covers, the result says."""
    return ["microstructure.inclusions.0.fraction=",
            f"microstructure.inclusions.0.radius={radius:.4f}"]


def ge_runs(n):
    jobs = {(c, k): (GE, [grid(n), ge_inclusion(c), f"constraint={k}"])
            for c in GE_FRACTIONS for k in ("periodic", "linear_displacement")}
    return runs(jobs)


def ge_estimates():
    got = runs({c: (GE, [ge_inclusion(c)]) for c in GE_FRACTIONS[1:]}, verb="bounds")
    series = {}
    for name in BOUNDS + tuple(ESTIMATES):
        for c, document in got.items():
            m = [m for m in document["methods"] if m["name"] == name][0]
            if m["valid"] and m.get("stiffness"):
                series.setdefault(name, []).append((c, m["stiffness"]))
    return series


@figure
def glass_epoxy():
    got, series = ge_runs(128), ge_estimates()
    beyond = runs({r: (GE, [grid(128), *ge_overlap(r), "constraint=periodic"])
                   for r in (0.505, 0.515, 0.53, 0.55, 0.58, 0.62)})
    exact = [r for r in reference("glass-epoxy-plane-strain.csv") if r["kind"] == "exact"]
    for entry, (i, j) in ENTRIES.items():
        fig, ax = plt.subplots(figsize=(8, 5.2))
        curve = {n: (np.array([c for c, _ in s]), np.array([m[i][j] for _, m in s]))
                 for n, s in series.items()}
        soft = stiffness(got[0.0, "periodic"], i, j)
        for lower, upper, shade, label in (
                ("reuss", "voigt", "#eeeeee", "Reuss to Voigt"),
                ("hashin_shtrikman_lower", "hashin_shtrikman_upper", "#cfd8dc",
                 "Hashin-Shtrikman (2D)")):
            x = np.append(0, curve[lower][0])
            ax.fill_between(x, np.append(soft, curve[lower][1]),
                            np.append(soft, curve[upper][1]), color=shade, lw=0, label=label)
        for n, (colour, line) in ESTIMATES.items():
            x, y = curve[n]
            ax.plot(np.append(0, x), np.append(soft, y), ls=line, color=colour,
                    label=n.replace("_", " "))
        for k, colour, mark in (("linear_displacement", BLACK, "^"), ("periodic", BLUE, "o")):
            ax.plot(GE_FRACTIONS, [stiffness(got[c, k], i, j) for c in GE_FRACTIONS], mark,
                    color=colour, mfc="white" if mark == "^" else colour,
                    label=f"perihom, {k.replace('_', ' ')}")
        late = sorted((r["fractions"]["glass"], stiffness(r, i, j)) for r in beyond.values())
        ax.plot(*zip(*late), "o", color=BLUE, mfc="white", ms=5,
                label="the same, disks that overlap")
        ax.plot([float(r["fraction"]) for r in exact], [float(r[entry]) for r in exact], "x",
                color=RED, ms=9, mew=1.8, label="exact, periodic")
        ax.axvline(math.pi / 4, color="#888888", lw=1, ls=":")
        top = 1.15 * late[-1][1]
        ax.annotate("disks touch", (math.pi / 4, 1.1 * soft), rotation=90, fontsize=9,
                    color="#666666", ha="right", va="bottom")
        ax.set_yscale("log")
        ticks = [t for t in (1, 1.5, 2, 3, 4, 6, 8, 10, 15, 20, 30, 40, 60) if soft < t < top]
        ax.set_yticks(ticks, [f"{t:g}" for t in ticks])
        ax.minorticks_off()
        ax.set(xlim=(0, 1), ylim=(0.97 * soft, top), xlabel="glass fraction [-]",
               ylabel=f"{entry} [GPa]")
        ax.legend(fontsize=9, ncol=1, loc="upper left")
        fig.tight_layout()
        save(fig, f"glass-epoxy-{entry}.png")
    glass_epoxy_tables(got, series, exact, beyond)


def glass_epoxy_tables(got, series, exact, beyond):
    page = "validation/glass-epoxy.md"
    fine = runs({(n, r["fraction"]): (GE, [grid(n), ge_inclusion(float(r["fraction"]))])
                 for r in exact for n in (64, 128, 256)})
    rows = []
    for r in exact:
        for n in (64, 128, 256):
            row = [r["fraction"], f"{n}²"]
            for e, (i, j) in ENTRIES.items():
                v = stiffness(fine[n, r["fraction"]], i, j)
                row += [f"{v:.4f}", signed(v, float(r[e]), 2)]
            rows.append(row)
        rows.append([r["fraction"], "**exact**"]
                    + [x for e in ENTRIES for x in (f"**{float(r[e]):.4f}**", "")])
    table(page, "exact", ["fraction", "nodes"] + [x for e in ENTRIES for x in (e, "error, %")],
          rows)
    pixels = [r for r in reference("glass-epoxy-plane-strain.csv") if r["kind"] == "pixels"]
    rows = []
    for r in pixels:
        v = got[[c for c in GE_FRACTIONS if abs(c - float(r["fraction"])) < 1e-9][0],
                "linear_displacement"]
        row = [r["fraction"]]
        for e, (i, j) in ENTRIES.items():
            row += [f"{stiffness(v, i, j):.3f}", r[e]]
        rows.append(row)
    table(page, "linear", ["fraction"] + [x for e in ENTRIES for x in (f"{e} perihom", "pixels")],
          rows)
    rows = []
    half = {n: dict((round(c, 3), m) for c, m in s) for n, s in series.items()}
    for n in BOUNDS + tuple(ESTIMATES):
        row = [n]
        for c in (0.1, 0.3, 0.5, 0.7):
            m = half[n].get(c)
            row.append(" / ".join(f"{m[i][j]:.2f}" for i, j in ENTRIES.values()) if m else "-")
        rows.append(row)
    for k in ("periodic", "linear_displacement"):
        rows.append([f"**perihom, {k}**"] + [
            " / ".join(f"{stiffness(got[c, k], i, j):.2f}" for i, j in ENTRIES.values())
            for c in (GE_FRACTIONS[2], GE_FRACTIONS[6], GE_FRACTIONS[10], GE_FRACTIONS[14])])
    table(page, "estimates", ["C11 / C12 / C66, GPa", "0.1", "0.3", "0.5", "0.7"], rows)
    glass_epoxy_statements(page, got, series, beyond)


def thesis_bounds(name, c):
    """(6-34), (6-35) of the thesis: the spatial Hashin-Shtrikman formulas, with spatial moduli."""
    K, G = zip(*[(E / (3 - 6 * nu), E / (2 + 2 * nu)) for E, nu in ((3.45, 0.35), (73.1, 0.22))])
    f = (1 - c, c)

    def of(a, b):
        if name == "k":
            return K[a] + f[b] / (1 / (K[b] - K[a]) + 3 * f[a] / (3 * K[a] + 4 * G[a]))
        t = 6 * f[a] * (K[a] + 2 * G[a]) / (5 * G[a] * (3 * K[a] + 4 * G[a]))
        return G[a] + f[b] / (1 / (G[b] - G[a]) + t)
    return of(0, 1), of(1, 0)


def glass_epoxy_statements(page, got, series, beyond):
    """The thesis's statements as numbers."""
    def matrix(document):
        return np.array(document["effective"]["stiffness"])

    def least(a, b):
        """Smallest eigenvalue of a - b, relative to |b|."""
        return np.linalg.eigvalsh(a - b)[0] / np.linalg.norm(b)
    rows = []
    orders = [("result - Reuss", lambda c: least(matrix(got[c, "periodic"]), bound("reuss", c))),
              ("Voigt - result", lambda c: least(bound("voigt", c),
                                                 matrix(got[c, "linear_displacement"]))),
              ("linear_displacement - periodic",
               lambda c: least(matrix(got[c, "linear_displacement"]),
                               matrix(got[c, "periodic"])))]

    def bound(name, c):
        return np.array([m for x, m in series[name] if x == c][0])
    inner = GE_FRACTIONS[1:]
    for what, f in orders:
        values = [f(c) for c in inner]
        rows.append([f"smallest eigenvalue of {what}, over the norm",
                     f"{min(values):+.2e} to {max(values):+.2e}"])
    gap = max(np.abs(bound("mori_tanaka", c) - bound("hashin_shtrikman_lower", c)).max()
              / np.linalg.norm(bound("mori_tanaka", c)) for c in inner)
    rows.append(["largest difference of Mori-Tanaka and the lower Hashin-Shtrikman bound",
                 f"{gap:.1e}"])
    half = inner[9]
    for name, (i, j), scale in (("k", (0, 1), 0.5), ("G", (2, 2), 1)):
        def pick(m):
            return scale * (m[0][0] + m[0][1]) if name == "k" else m[2][2]
        plane = [pick(bound(f"hashin_shtrikman_{s}", half)) for s in ("lower", "upper")]
        rows.append([f"{name} at 0.5: bounds of the plane; the thesis's formulas; periodic result",
                     "{:.3f} to {:.3f}; {:.3f} to {:.3f}; {:.3f}".format(
                         *plane, *thesis_bounds(name, half),
                         pick(matrix(got[half, "periodic"])))])
    for c in (inner[0], inner[1], inner[3], inner[5], inner[9]):
        miss = 100 * (bound("dilute", c)[0, 0] / stiffness(got[c, "periodic"], 0, 0) - 1)
        rows.append([f"C11 of dilute against the periodic result at {c:.2f}", f"{miss:+.1f} %"])
    points = sorted([(c, stiffness(got[c, "periodic"], 0, 0)) for c in inner if c > 0.59]
                    + [(r["fractions"]["glass"], stiffness(r, 0, 0)) for r in beyond.values()])
    slopes = [((a[0] + b[0]) / 2, (b[1] - a[1]) / (b[0] - a[0]))
              for a, b in zip(points, points[1:])]
    rows.append(["slope of C11 (GPa per unit fraction) at fraction",
                 ", ".join(f"{x:.3f}: {s:.0f}" for x, s in slopes)])
    table(page, "statements", ["measured at 128²", ""], rows)


# ---- validation: tables 6-3 to 6-6 -------------------------------------------------------

@figure
def tables_6_3_to_6_6():
    published = reference("tables-6-3-to-6-6.csv")
    fractions = sorted({float(r["fraction"]) for r in published})

    def sets(shape, c, n):
        if c == 0:
            return [grid(n), "microstructure.inclusions="]
        a = math.sqrt(2 * c / math.pi)
        inclusion = (f"microstructure.inclusions.0.semi_axes=[{a:.9f},{a / 2:.9f}]"
                     if shape == "ellipse" else f"microstructure.inclusions.0.fraction={c:g}")
        return [grid(n), inclusion]
    jobs = {(f, s, c, n): (f"{f}-aluminium-{s}.yaml", sets(s, c, n))
            for f in ("glass", "graphite") for s in ("circle", "ellipse")
            for c in fractions for n in (32, 256)}
    got = runs(jobs)
    bounds = runs({(f, c): (f"{f}-aluminium-circle.yaml", sets("circle", c, 32))
                   for f in ("glass", "graphite") for c in fractions[1:]}, verb="bounds")
    fig, axes = plt.subplots(2, 2, figsize=(9.6, 7.4), sharex=True)
    for ax, t in zip(axes.flat, ("6-3", "6-4", "6-5", "6-6")):
        rows = [r for r in published if r["table"] == t]
        draw_table(ax, t, rows, got, bounds, fractions)
    for ax in axes[1]:
        ax.set_xlabel("fraction [-]")
    handles, labels = axes[1, 1].get_legend_handles_labels()
    fig.legend(handles, labels, loc="lower center", ncol=4, fontsize=9)
    fig.tight_layout(rect=(0, 0.07, 1, 1))
    save(fig, "tables-6-3-to-6-6.png")
    for t in ("6-3", "6-4", "6-5", "6-6"):
        page_table(t, [r for r in published if r["table"] == t], got, bounds)


def of_bound(bounds, f, c, name):
    m = [m for m in bounds[f, c]["methods"] if m["name"] == name][0]
    return m["engineering"]["E1"]


def draw_table(ax, t, rows, got, bounds, fractions):
    f, s = rows[0]["inclusion"], rows[0]["shape"]
    x = fractions[1:]
    low, high = ("reuss", "voigt") if s == "ellipse" else ("walpole_lower", "voigt")
    ax.fill_between([0] + x, [68.3] + [of_bound(bounds, f, c, low) for c in x],
                    [68.3] + [of_bound(bounds, f, c, high) for c in x], color="#e8ecee", lw=0,
                    label="bounds")
    for d, line in (("E1", "-"), ("E2", "--")):
        mine = [r for r in rows if r["direction"] == d]
        if not mine:
            continue
        name = f" {d}" if s == "ellipse" else ""
        apart = 0.004 * ((d == "E2") - (d == "E1")) * (s == "ellipse")
        x = [c + apart for c in fractions]
        ax.plot(x, [float(r["PD"]) for r in mine], "s", color=ORANGE,
                mfc=ORANGE if d == "E1" else "white", label="published PD" + name)
        ax.plot(x, [float(r["FEM"]) for r in mine], "^", color=GREEN,
                mfc=GREEN if d == "E1" else "white", label="published FEM" + name)
        ax.plot(fractions, [constants(got[f, s, c, 256])[d] for c in fractions], line,
                color=BLUE, label="perihom 256²" + name)
    ax.set_title(f"Table {t}: {f} {s} in aluminium")
    ax.set_ylabel("E [GPa]")


def page_table(t, rows, got, bounds):
    f, s = rows[0]["inclusion"], rows[0]["shape"]
    out = []
    for r in rows:
        c, d = float(r["fraction"]), r["direction"]
        coarse, fine = (constants(got[f, s, c, n])[d] for n in (32, 256))
        low = of_bound(bounds, f, c, "walpole_lower") if c else 68.3
        high = of_bound(bounds, f, c, "voigt") if c else 68.3
        out.append(([d] if s == "ellipse" else [])
                   + [r["fraction"], r["PD"], r["FEM"], f"{coarse:.3f}", f"**{fine:.3f}**",
                      signed(float(r["PD"]), fine, 2), signed(float(r["FEM"]), fine, 2)]
                   + ([] if s == "ellipse" else [f"{low:.2f}"]) + [f"{high:.2f}"])
    table("validation/tables-6-3-to-6-6.md", t,
          (["direction"] if s == "ellipse" else [])
          + ["fraction", "PD", "FEM", "perihom 32²", "perihom 256²", "PD off, %", "FEM off, %"]
          + ([] if s == "ellipse" else ["2D lower bound"]) + ["Voigt"], out)


# ---- theory: what the choices do -------------------------------------------------------

def ba_worst(result):
    """Largest relative error of the six constants of boron/aluminium, %; iterations."""
    exact = {r["constant"]: float(r["value"]) for r in reference("boron-aluminium-exact.csv")
             if r["kinematics"] == "generalised_strain"}
    if "failed" in result:
        return math.nan, math.nan
    e = constants(result)
    return (100 * max(abs(e[c] / exact[c] - 1) for c in exact),
            max(result["solver"]["iterations"]))


@figure
def families_drawn():
    """Families of one node and of one stress point."""
    fig, axes = plt.subplots(1, 3, figsize=(9.6, 3.7))
    i, j = np.meshgrid(range(-4, 5), range(-4, 5))
    for ax, title in zip(axes, ("nodes, horizon 2", "stress points, smallest family",
                                "stress points, horizon 1.6")):
        nodes = "nodes" in title
        x, y = (i, j) if nodes else (i + 0.5, j + 0.5)
        r = np.hypot(x, y)
        if nodes:
            beta = np.clip(2.5 - r, 0, 1)
            beta[r == 0] = 0
        else:
            beta = (r <= (0.7072 if "smallest" in title else 1.6)).astype(float)
        for e in np.arange(-4.5, 5, 1) if nodes else np.arange(-4, 5):
            ax.axhline(e, color="#e4e4e4", lw=0.8, zorder=0)
            ax.axvline(e, color="#e4e4e4", lw=0.8, zorder=0)
        for a, b, w in zip(x.flat, y.flat, beta.flat):
            if w > 0:
                ax.plot([0, a], [0, b], color=BLUE, alpha=0.25 + 0.6 * w, lw=1)
        ax.scatter(x, y, s=34, c="#cccccc", zorder=2, lw=0)
        ax.scatter(x, y, s=34 * beta, c=BLUE, zorder=3, lw=0)
        ax.plot(0, 0, "s" if not nodes else "o", color=RED, ms=7, zorder=4)
        radius = 2 if nodes else 0.7071 if "smallest" in title else 1.6
        ax.add_patch(plt.Circle((0, 0), radius, fill=False, color=BLACK, lw=1, ls="--"))
        ax.set(xlim=(-3.1, 3.1), ylim=(-3.1, 3.1), aspect="equal", title=title, xticks=[],
               yticks=[])
        ax.grid(False)
        for side in ax.spines.values():
            side.set_visible(False)
    fig.tight_layout()
    save(fig, "families-drawn.png")


@figure
def nosb():
    kinds = [("nodes", h) for h in (1, 1.5, 2, 3, 4)] + [("stress", h) for h in (None, 1.6, 2.6)]
    sets = {k: [f"model.points={k[0]}", f"model.horizon={k[1] or 'auto'}"] for k in kinds}
    sets["finite elements"] = ["model.kind=local", "model.horizon="]
    jobs = {(k, n): (BA, [grid(n), *s]) for k, s in sets.items() for n in (32, 64, 128)}
    got = runs(jobs)
    rows = []
    for k in sets:
        e = [ba_worst(got[k, n]) for n in (32, 64, 128)]
        name = k if isinstance(k, str) else \
            f"{k[0]}, {'smallest family' if k[1] is None else f'horizon {k[1]}'}"
        rows.append([name] + [f"{x[0]:.2f}" for x in e] + [e[1][1], got[k, 64]["solver"]["route"]])
    table("theory/nosb.md", "families", ["points", "32², worst error, %", "64²", "128²",
          "iterations at 64²", "route"], rows)


@figure
def stabilisation():
    alphas = [10.0**-k for k in range(1, 8)]
    thetas = [0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0]
    jobs = {}
    for n in (64, 128):
        for a in alphas:
            for p in ("nodes", "stress"):
                jobs[n, p, a] = (BA, [grid(n), f"model.points={p}",
                                      f"model.horizon={2 if p == 'nodes' else 'auto'}",
                                      f"model.stabilisation={{spectral: {a:g}}}"])
        for t in thetas:
            jobs[n, "theta", t] = (BA, [grid(n), "model.points=stress", "model.horizon=",
                                        f"model.stabilisation={{subpoint: {t:g}}}"])
    got = runs(jobs)
    fig, axes = plt.subplots(1, 2, figsize=(9.6, 4.4), sharey=True)
    for (n, line) in ((64, "-"), (128, "--")):
        for p, colour, mark, label in (("nodes", RED, "s", "nodes, horizon 2"),
                                       ("stress", BLUE, "o", "stress points")):
            axes[0].loglog(alphas, [ba_worst(got[n, p, a])[0] for a in alphas], line,
                           marker=mark, color=colour, label=f"{label}, {n}²")
        axes[1].loglog(thetas, [ba_worst(got[n, "theta", t])[0] for t in thetas], line,
                       marker="^", color=GREEN, label=f"stress points, {n}²")
    axes[0].axvline(1e-5, color="#888888", lw=1, ls=":")
    for theta in (0.01, 0.05):
        axes[1].axvline(theta, color="#888888", lw=1, ls=":")
    axes[0].set(xlabel="alpha of (S) [-]", ylabel="worst error of six constants [%]",
                title="spectral")
    axes[1].set(xlabel="theta of (P) [-]", title="sub-point")
    for ax in axes:
        ax.legend(fontsize=9)
    fig.tight_layout()
    save(fig, "stabilisation.png")
    rows = []
    for a in alphas:
        row = [f"{a:g}"]
        for p in ("nodes", "stress"):
            e, it = ba_worst(got[64, p, a])
            q = got[64, p, a]["quality"]["stabilisation_energy"] if e == e else math.nan
            row += [f"{e:.3f}", it, f"{q:.1e}"]
        rows.append(row)
    table("theory/stabilisation.md", "alpha", ["alpha", "nodes: worst error, %", "iterations",
          "share of the energy", "stress points: worst error, %", "iterations",
          "share of the energy"], rows)
    rows = [[f"{t:g}", *(f"{x:.3f}" for x in [ba_worst(got[64, "theta", t])[0]]),
             ba_worst(got[64, "theta", t])[1],
             f"{ba_worst(got[128, 'theta', t])[0]:.3f}"] for t in thetas]
    table("theory/stabilisation.md", "theta", ["theta", "worst error at 64², %", "iterations",
          "worst error at 128², %"], rows)


@figure
def contrast():
    """Antiplane modulus G13 against Rayleigh's series, and iterations, by contrast."""
    f, n = 0.4, 64
    kinds = {"nodes, horizon 2, (S) 1e-5": ["model.points=nodes", "model.horizon=2",
                                            "model.stabilisation={spectral: 1e-5}"],
             "stress points, (S) 1e-5": ["model.points=stress", "model.horizon=",
                                         "model.stabilisation={spectral: 1e-5}"],
             "stress points, (P) 0.05": ["model.points=stress", "model.horizon=",
                                         "model.stabilisation={subpoint: 0.05}"],
             "stress points, (P) 1": ["model.points=stress", "model.horizon=",
                                      "model.stabilisation={subpoint: 1}"],
             "finite elements": ["model.kind=local", "model.horizon="]}
    base = ["materials.aluminium={E: 1, nu: 0.3}", f"microstructure.inclusions.0.fraction={f}",
            "solver={kind: fft_cg, max_iterations: 600}", grid(n)]
    contrasts = (10, 100, 1e4, 0)
    jobs = {(k, i, c): (BA, base + s + [f"microstructure.interface={i}",
                        "materials.boron=" + (f"{{E: {c:g}, nu: 0.3}}" if c else "{void: true}")])
            for k, s in kinds.items() for i in ("composite", "node_centre") for c in contrasts}
    got = runs(jobs)
    rows = []
    for k in kinds:
        for i in ("composite", "node_centre"):
            row = [k, i]
            for c in contrasts:
                r = got[k, i, c]
                if "failed" in r:
                    row.append("> 600" if r["failed"] == 4 else "refused")
                else:
                    g = constants(r)["G13"] * 2.6
                    row.append(f"{max(r['solver']['iterations'])} ({signed(g, rayleigh(f, c), 2)})")
            rows.append(row)
    table("theory/stabilisation.md", "contrast", ["operator", "cut cells"]
          + [f"contrast {c:g}" if c else "void" for c in contrasts], rows)


@figure
def families():
    influences = ("constant", "conical", "gaussian", "inverse", "inverse_square", "cubic")
    horizons = (1, 1.25, 1.5, 2, 2.5, 3, 4, 5)
    jobs = {(f, h): (BA, [grid(64), "model.points=nodes", f"model.horizon={h}",
                          f"model.influence={f}"]) for f in influences for h in horizons}
    for w in ("linear", "exact", "none"):
        for h in horizons:
            jobs[w, h] = (BA, [grid(64), "model.points=nodes", f"model.horizon={h}",
                               f"model.weights={w}"])
    got = runs(jobs)
    fig, axes = plt.subplots(1, 2, figsize=(9.6, 4.4), sharey=True)
    look = zip((BLUE, ORANGE, GREEN, RED, PINK, SKY), "os^Dvp")
    for f, (colour, mark) in zip(influences, look):
        axes[0].semilogy(horizons, [ba_worst(got[f, h])[0] for h in horizons], "-", marker=mark,
                         color=colour, label=f)
    for w, colour, mark, line in (("linear", BLUE, "o", "-"), ("exact", ORANGE, "s", "--"),
                                  ("none", GREEN, "^", ":")):
        axes[1].semilogy(horizons, [ba_worst(got[w, h])[0] for h in horizons], line, marker=mark,
                         color=colour, label=w)
    axes[0].set(xlabel="horizon [spacings]", ylabel="worst error of six constants [%]",
                title="influence function (weights linear)")
    axes[1].set(xlabel="horizon [spacings]", title="volume weights (influence constant)")
    for ax, where in zip(axes, ("lower right", "upper left")):
        ax.legend(fontsize=9, loc=where)
        ax.set_ylim(0.02, 1)
        ax.set_yticks([0.02, 0.05, 0.1, 0.2, 0.5, 1], ["0.02", "0.05", "0.1", "0.2", "0.5", "1"])
        ax.minorticks_off()
    fig.tight_layout()
    save(fig, "families.png")

    def cell(key, h):
        e, it = ba_worst(got[key, h])
        return "refused" if e != e else f"{e:.2f} ({it})"
    table("theory/families.md", "influence", ["influence"] + [f"horizon {h}" for h in horizons],
          [[f] + [cell(f, h) for h in horizons] for f in influences])
    table("theory/families.md", "weights", ["weights"] + [f"horizon {h}" for h in horizons],
          [[w] + [cell(w, h) for h in horizons] for w in ("linear", "exact", "none")])


CONSTRAINTS = (("linear_displacement", RED, "^"), ("periodic", BLUE, "o"),
               ("uniform_traction", GREEN, "v"))


@figure
def constraints():
    """An RVE of k x k cells, 24 nodes a cell, one stabilisation for all constraints."""
    sizes = (1, 2, 4, 8)

    def cells(k, c):
        disks = ",".join("{shape: disk, centre: [%.9g, %.9g], fraction: %.9g, material: glass}"
                         % ((i + 0.5) / k, (j + 0.5) / k, 0.5 / k**2)
                         for i in range(k) for j in range(k))
        return [grid(24 * k), f"microstructure.inclusions=[{disks}]", f"constraint={c}",
                "model={points: stress, stabilisation: {subpoint: 0.05}}"]
    got = runs({(k, c): (GE, cells(k, c)) for k in sizes for c, _, _ in CONSTRAINTS})
    fig, axes = plt.subplots(1, 3, figsize=(9.6, 4.0))
    for ax, (e, (i, j)) in zip(axes, ENTRIES.items()):
        for c, colour, mark in CONSTRAINTS:
            ax.semilogx(sizes, [stiffness(got[k, c], i, j) for k in sizes], "-", marker=mark,
                        color=colour, label=c.replace("_", " "))
        ax.set(title=e, xlabel="cells along an edge of the RVE")
        ax.set_xticks(sizes, [str(k) for k in sizes])
        ax.minorticks_off()
    axes[0].set_ylabel("GPa")
    handles, labels = axes[0].get_legend_handles_labels()
    fig.legend(handles, labels, loc="lower center", ncol=3)
    fig.tight_layout(rect=(0, 0.08, 1, 1))
    save(fig, "constraints.png")
    rows = []
    for k in sizes:
        for c, _, _ in CONSTRAINTS:
            r = got[k, c]
            rows.append([f"{k} x {k}", c] + [f"{stiffness(r, *ij):.4f}" for ij in ENTRIES.values()]
                        + [max(r["solver"]["iterations"]), f"{r['quality']['hill_mandel']:.0e}"])
    table("theory/constraints.md", "sizes", ["cells", "constraint"] + [f"{e}, GPa" for e in ENTRIES]
          + ["iterations", "Hill-Mandel residual"], rows)
    jobs = {}
    for h in (1, 2, 4, 8):
        for c in ("inside", "periodic", "matrix"):
            jobs[h, c] = (GE, [grid(64), "model.points=nodes", f"model.horizon={h}",
                               f"constraint={{kind: linear_displacement, collar: {c}}}"])
        jobs[h, "none"] = (GE, [grid(64), "model.points=nodes", f"model.horizon={h}"])
    got = runs(jobs)
    rows = []
    for h in (1, 2, 4, 8):
        for c in ("none", "inside", "periodic", "matrix"):
            r = got[h, c]
            if "failed" in r:
                rows.append([h, c, "-", "-", "-", "not converged", ""])
                continue
            rows.append([h, "(constraint periodic)" if c == "none" else c]
                        + [f"{stiffness(r, *ij):.4f}" for ij in ENTRIES.values()]
                        + [max(r["solver"]["iterations"]), f"{r['quality']['hill_mandel']:.0e}"])
    table("theory/constraints.md", "collars", ["horizon, spacings", "collar"]
          + [f"{e}, GPa" for e in ENTRIES] + ["iterations", "Hill-Mandel residual"], rows)


@figure
def kinematics():
    got = runs({k: (BA, [grid(128), f"microstructure.plane={k}"])
                for k in ("generalised_strain", "strain", "stress")})
    exact = {(r["kinematics"], r["constant"]): r["value"]
             for r in reference("boron-aluminium-exact.csv")}
    rows = []
    for k, r in got.items():
        e = constants(r)
        rows.append([k] + [f"{e[c]:.4f}" + (f" ({exact[k, c]})" if (k, c) in exact else "")
                           if c in e else "-" for c in ("E1", "nu12", "G12", "E3", "nu31", "G13")])
    table("theory/kinematics.md", "planes", ["plane", "E1", "nu12", "G12", "E3", "nu31", "G13"],
          rows)


# ---- the picture of the README ---------------------------------------------------------

@figure
def boron_aluminium():
    """Phases, and the stress 11 of the load 11, four cells of the array."""
    import h5py
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([ARGS.perihom, "run", str(ROOT / "data/cases" / BA), "-q", "-o", folder,
                        "--set", "output.fields=true", "--set", grid(256), "--force"],
                       check=True, stdout=subprocess.DEVNULL)
        draw_readme(h5py.File(folder + "/fields.h5"))


def draw_readme(h5):
    phase = np.array(h5["phase"])[0]
    stress = np.array(h5["loads/11/stress/11"])[0]
    stress = stress / stress.mean()
    tile = lambda a: np.tile(a, (2, 2))
    fig, axes = plt.subplots(1, 2, figsize=(10, 4.6), width_ratios=(1, 1.13))
    n = 2 * len(phase)
    at = (np.arange(n) + 0.5) * 2 / n
    axes[0].set_facecolor("#d9dee3")
    axes[0].contourf(at, at, tile(phase), levels=[0.5, 1.5], colors=["#37474f"])
    axes[0].text(0.5, 0.5, "boron", color="white", ha="center", va="center")
    axes[0].text(1.0, 1.0, "aluminium", color="#37474f", ha="center", va="center", fontsize=9)
    axes[0].set_title("phases")
    shown = axes[1].imshow(tile(stress), origin="lower", extent=(0, 2, 0, 2), cmap="viridis",
                           interpolation="bilinear")
    angle = np.linspace(0, 2 * np.pi, 200)
    r = math.sqrt(0.47 / math.pi)
    for i in range(2):
        for j in range(2):
            axes[1].plot(i + 0.5 + r * np.cos(angle), j + 0.5 + r * np.sin(angle),
                         color="white", lw=0.8, alpha=0.8)
    axes[1].set_title("stress 11 over its mean, stretched along 1")
    fig.colorbar(shown, ax=axes[1], fraction=0.046, pad=0.03)
    for ax in axes:
        ax.set(xlim=(0, 2), ylim=(0, 2), xticks=[0, 1, 2], yticks=[0, 1, 2], xlabel="axis 1 [um]",
               aspect="equal")
        ax.grid(False)
    axes[0].set_ylabel("axis 2 [um]")
    fig.tight_layout()
    save(fig, "boron-aluminium.png")

@figure
def tutorial():
    """The two pictures of the tutorial, which the program itself makes."""
    examples = ROOT / "docs/examples"
    with tempfile.TemporaryDirectory() as folder:
        def call(*command):
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL, cwd=folder)
        call(ARGS.perihom, "run", examples / "fibre.yaml", "-q", "-o", "fibre", "--set",
             "output.fields=true", "--set", grid(256))
        call(ARGS.perihom, "view", "fibre", "--load", "11", "--field", "stress11")
        call(sys.executable, examples / "twelve_fibres.py")
        case = Path(folder) / "twelve_fibres.yaml"
        case.write_text((examples / "twelve_fibres.yaml").read_text())
        call(ARGS.perihom, "run", case, "-q", "-o", "voxels")
        (PICTURES / "tutorial-stress11.png").write_bytes(
            (Path(folder) / "fibre/stress11-load11.png").read_bytes())
        (PICTURES / "tutorial-voxels.png").write_bytes(
            (Path(folder) / "voxels/phases.png").read_bytes())


@figure
def failure():
    for case in ("edge-crack", "debonding-fibre"):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([ARGS.perihom, "run", ROOT / f"data/cases/{case}.yaml", "-q", "-o",
                            "result"], check=True, stdout=subprocess.DEVNULL, cwd=folder)
            for name in ("damage.png", "stress-strain.svg"):
                (PICTURES / f"failure-{case}-{name}").write_bytes(
                    (Path(folder) / "result" / name).read_bytes())


# ---- main ------------------------------------------------------------------------------

def main():
    global ARGS
    p = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    p.add_argument("--perihom", default=str(ROOT / "build/tools/perihom"))
    p.add_argument("--cache", default=str(ROOT / "build/figures-cache"))
    p.add_argument("--jobs", type=int, default=os.cpu_count())
    p.add_argument("--only", nargs="*", metavar="NAME", help="some of them; --list names them")
    p.add_argument("--list", action="store_true")
    ARGS = p.parse_args()
    if ARGS.list:
        print("\n".join(FIGURES))
        return
    ARGS.version = subprocess.run([ARGS.perihom, "version"], capture_output=True, text=True,
                                  check=True).stdout.split("\n")[0]
    for name in ARGS.only or FIGURES:
        if name not in FIGURES:
            sys.exit(f"no figure {name}; --list names them")
        print(name, file=sys.stderr)
        FIGURES[name]()


if __name__ == "__main__":
    main()
