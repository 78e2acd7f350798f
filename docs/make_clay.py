#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the tables and figures of docs/validation/epoxy-clay.md again.

    ninja -C build tests/clay_table
    python3 docs/make_clay.py [--table build/tests/clay_table] [--cache FOLDER] [--draw] [--only PART ...]

Needs python3-matplotlib (Debian). Every number is a mean over realisations that clay_table
computes; answers are kept in --cache by case text and overrides, delete it after a change of the
program. Figures go to docs/pictures, tables into the page between `<!-- table: NAME -->` and
`<!-- end -->`. --draw: only from answers that are there. From an empty cache: a few minutes of
processor time."""
import argparse
import hashlib
import json
import re
import subprocess
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/validation/epoxy-clay.md"
ORANGE, SKY, GREEN, BLUE, RED = "#e69f00", "#56b4e9", "#009e73", "#0072b2", "#d55e00"
plt.rcParams.update({"savefig.dpi": 160, "font.size": 11, "axes.grid": True, "grid.color": "#dddddd",
                     "axes.spines.top": False, "axes.spines.right": False, "legend.frameon": False})
FILLER = "microstructure.fillers.0."
FRAME = "constraint={kind: linear_displacement, collar: matrix}"
ARGS = None


def mean(case, n, *sets):
    """The means over n realisations of a case, or None with --draw where they are missing."""
    path = ROOT / "data/cases" / (case + ".yaml")
    key = hashlib.sha1(json.dumps([path.read_text(), n, sets]).encode()).hexdigest()
    kept = Path(ARGS.cache) / (key + ".json")
    if not kept.exists():
        if ARGS.draw:
            return None
        got = subprocess.run([ARGS.table, str(path), str(n), *sets], capture_output=True, text=True)
        if got.returncode:
            print(case, *sets, got.stderr.strip(), sep="\n  ")
            return None
        kept.parent.mkdir(parents=True, exist_ok=True)
        kept.write_text(got.stdout)
    return json.loads(kept.read_text())


def both(r):
    """Mean of E11 and E22 (no direction is special) and its standard error, which takes the two
    as one observation: they belong to the same realisations."""
    return (r["E1"] + r["E2"]) / 2, max(r["E1_error"], r["E2_error"])


def replace_table(name, lines):
    text = PAGE.read_text()
    mark = re.compile(rf"(<!-- table: {name} -->\n).*?(<!-- end -->)", re.S)
    if not mark.search(text):
        raise SystemExit(f"{PAGE} has no table {name}")
    PAGE.write_text(mark.sub(lambda m: m[1] + "\n".join(lines) + "\n" + m[2], text))


def box(size, nodes):
    return [f"microstructure.size=[{size},{size}]", f"microstructure.nodes=[{nodes},{nodes}]"]


# ---- contents of clay ------------------------------------------------------------------------

VALIDATION = {
    "exfoliated": dict(case="epoxy-clay-exfoliated", Em=1.96, contents=(1, 2.5, 3.5, 5), n=16,
                       title="exfoliated: $\\kappa$ = 15, calibrated on 5 wt %", stated=4, tests={}),
    "agglomerated": dict(case="epoxy-clay-agglomerated", Em=3.5, contents=(1, 3, 5), n=8,
                         title="poorly dispersed: $\\kappa$ = 0.05, calibrated on 5 wt %", stated=3,
                         tests={0: 3.50, 3: 3.47}),
}


def contents():
    figure, axes = plt.subplots(1, 2, figsize=(10, 4))
    lines = ["| case | wt % | platelets | realisations | frame: E ± std (error), GPa | periodic: E ± std (error), GPa"
             " | frame, E / E_m | test |", "|---|---|---|---|---|---|---|---|"]
    for ax, (name, v) in zip(axes, VALIDATION.items()):
        for label, sets, colour, marker in (("frame of matrix (the thesis's)", [FRAME], BLUE, "o"),
                                            ("periodic", [], ORANGE, "s")):
            v[label] = {w: mean(v["case"], v["n"], *sets, f"{FILLER}weight_fraction={w / 100:g}")
                        for w in v["contents"]}
            have = {w: both(r) for w, r in v[label].items() if r}
            ax.errorbar([0, *have], [v["Em"], *(e for e, _ in have.values())],
                        [0, *(2 * s for _, s in have.values())], color=colour, marker=marker, capsize=3, label=label)
        frame, periodic = list(v.values())[-2:]
        for w in v["contents"]:
            a, b = frame[w], periodic[w]
            if not (a and b):
                continue
            cell = ["{:.3f} ± {:.3f} ({:.4f})".format(both(r)[0], (r["E1_std"] + r["E2_std"]) / 2, both(r)[1])
                    for r in (a, b)]
            lines.append(f"| {name} | {w:g} | {a['fillers']:.1f} | {a['realisations']} | {cell[0]} | {cell[1]} | "
                         f"{both(a)[0] / v['Em']:.3f} | {v['tests'].get(w, '')} |")
        if v["tests"]:
            ax.plot(list(v["tests"]), list(v["tests"].values()), "k*", markersize=10, label="tests (thesis 3.2.4)")
        have = {w: both(r)[0] for w, r in frame.items() if r}
        ax.fill_between([0, *have], [e * (1 - v["stated"] / 100) for e in (v["Em"], *have.values())],
                        [e * (1 + v["stated"] / 100) for e in (v["Em"], *have.values())], color=SKY, alpha=0.25,
                        linewidth=0, label=f"± {v['stated']} %, the stated largest error")
        ax.set(xlabel="clay, wt %", ylabel="Young's modulus, GPa", title=v["title"])
        ax.legend(fontsize=9)
    figure.tight_layout()
    figure.savefig(ROOT / "docs/pictures/epoxy-clay-contents.png")
    replace_table("contents", lines)


# ---- grid, horizon, interphase ------------------------------------------------------------------

N = 8  # realisations
KAPPA = FILLER + "interphase={kappa: %g}"
NONE = FILLER + "interphase="
# Platelets that the grids below resolve: 300 nm x 20 nm, the same ones on every grid.
THICK = [FILLER + "thickness=20", FILLER + "aspect_ratio={normal: {mean: 15, std: 3, min: 5}}",
         FILLER + "counting=area"]
SOFT = ["materials.soft={E: 0.35, nu: 0.3333333333333333}"]
LAYER = FILLER + "interphase={thickness: %g, material: soft}"


def row(label, *sets, size=600, nodes=60, n=N):
    r = mean("epoxy-clay", n, *box(size, nodes), *sets)
    return label, r


def models():
    rows = []
    for m in (4, 8, 16):
        for k in (0.1, 1):
            rows.append(row(f"bond | one node | 10 nm | {10 * m} nm | kappa {k:g}", f"model.horizon={m}", KAPPA % k))
    rows.append(row("bond | one node | 10 nm | 80 nm | none (harmonic mean)", NONE))
    rows.append(row("bond | one node | 5 nm | 80 nm | kappa 0.1", "model.horizon=16", nodes=120))
    rows.append(row("bond | one node | 5 nm | 40 nm | kappa 0.1", "model.horizon=8", nodes=120))
    for kind in ("nosb", "local"):
        rows.append(row(f"{kind} | one node | 10 nm | - | none", "model=" + "{kind: %s}" % kind, NONE))
        rows.append(row(f"{kind} | one node | 10 nm | - | soft layer 20 nm", "model=" + "{kind: %s}" % kind, *SOFT,
                        LAYER % 20))
        rows.append(row(f"{kind} | one node | 10 nm | - | soft layer 80 nm", "model=" + "{kind: %s}" % kind, *SOFT,
                        LAYER % 80))
    thin = [NONE, FILLER + "counting=area"]
    rows.append(row("bond | 1 nm, cell centres | 10 nm | 80 nm | kappa 0.1", FILLER + "counting=area"))
    for kind in ("nosb", "local"):
        rows.append(row(f"{kind} | 1 nm, composite cells | 10 nm | - | none", "model=" + "{kind: %s}" % kind, *thin,
                        "microstructure.interface=composite"))
    for h in (10, 5, 2.5):
        for kind in ("nosb", "local"):
            rows.append(row(f"{kind} | 20 nm | {h:g} nm | - | none", "model=" + "{kind: %s}" % kind, NONE, *THICK,
                            nodes=int(600 / h)))
            rows.append(row(f"{kind} | 20 nm | {h:g} nm | - | soft layer 20 nm", "model=" + "{kind: %s}" % kind, *SOFT,
                            *THICK, LAYER % 20, nodes=int(600 / h)))
    for h, m in ((10, 8), (5, 16), (10, 4), (5, 8), (2.5, 16)):
        rows.append(row(f"bond | 20 nm | {h:g} nm | {h * m:g} nm | kappa 0.1", f"model.horizon={m}", KAPPA % 0.1, *THICK,
                        nodes=int(600 / h)))
    lines = ["| model | platelet's thickness | spacing | horizon | interphase | filler in the picture | E ± error, GPa |",
             "|---|---|---|---|---|---|---|"]
    for label, r in rows:
        if r:
            e, s = both(r)
            lines.append(f"| {label} | {r['fraction']:.4f} | {e:.3f} ± {s:.3f} |")
    replace_table("models", lines)


def kappas():
    figure, ax = plt.subplots(figsize=(6, 4.2))
    lines = ["| kappa | " + " | ".join(f"horizon {10 * m} nm" for m in (3, 4, 6, 8, 12)) + " |", "|---|" + "---|" * 5]
    values = (0.05, 0.1, 0.3, 1, 3, 15)
    all_ = {(k, m): mean("epoxy-clay", 10, *box(600, 60), f"model.horizon={m}", KAPPA % k)
            for m in (3, 4, 6, 8, 12) for k in values}
    for k in values:
        lines.append(f"| {k:g} | " + " | ".join("{:.3f} ± {:.3f}".format(*both(all_[k, m])) if all_[k, m] else "-"
                                               for m in (3, 4, 6, 8, 12)) + " |")
    for m, colour, marker in zip((3, 4, 6, 8, 12), (ORANGE, SKY, GREEN, BLUE, RED), "os^vD"):
        have = [(k, *both(all_[k, m])) for k in values if all_[k, m]]
        if have:
            ax.errorbar([h[0] for h in have], [h[1] for h in have], [2 * h[2] for h in have], color=colour, marker=marker,
                        capsize=3, label=f"horizon {10 * m} nm")
    ax.axhline(3.5, color="k", linewidth=0.8, linestyle=":")
    ax.set(xscale="log", xlabel="$\\kappa$", ylabel="Young's modulus, GPa", title="5 wt %, spacing 10 nm")
    ax.legend(fontsize=9)
    figure.tight_layout()
    figure.savefig(ROOT / "docs/pictures/epoxy-clay-kappa.png")
    replace_table("kappa", lines)


def main():
    global ARGS
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--table", default=str(ROOT / "build/tests/clay_table"))
    p.add_argument("--cache", default=str(ROOT / "build/clay-cache"))
    p.add_argument("--draw", action="store_true")
    p.add_argument("--only", nargs="+", default=["kappas", "models", "contents"])
    ARGS = p.parse_args()
    for part in (kappas, models, contents):
        if part.__name__ in ARGS.only:
            part()


if __name__ == "__main__":
    main()
