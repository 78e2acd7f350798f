#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Do error bars hold the truth? Random cases, solved with their bars and on much finer grids.

usage: make_coverage.py run PERIHOM ROWS.jsonl [--first 0] [--cases 352] [--seed 5000]
       make_coverage.py bars PERIHOM ROWS.jsonl   (the bars of a newer program, the references stay)
       make_coverage.py table ROWS.jsonl          (table and figure of docs/validation/error-bars.md)

Needs python3-numpy. A row a case, which is written when it is done: a run that was stopped goes on.
The factors of the bars were found on seeds 1000 to 1399 (of an earlier form of this script).
"""
import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
PLANE = ["disk", "ellipse", "box", "layer", "several", "particles", "platelets", "void", "nodes", "centre", "voxels",
         "cracks", "relaxing"]
SPACE = ["sphere", "ellipsoid", "cylinder", "box", "layer", "several", "particles", "void", "centre"]
CLASSES = [(2, c) for c in PLANE] + [(3, c) for c in SPACE]


# ---- cases ----

def shape(rng, kind, dim, size=1.0):
    def u(lo, hi):
        return float(rng.uniform(lo, hi))
    out = {"shape": kind, "centre": [u(0, 1) for _ in range(dim)], "material": "i"}
    a = size * u(0.18, 0.42)
    if kind in ("disk", "sphere"):
        out["radius"] = a
    elif kind == "ellipse":
        out.update(semi_axes=[a, a * u(0.35, 1)], angle=u(0, 180))
    elif kind == "ellipsoid":
        out.update(semi_axes=[a, a * u(0.4, 1), a * u(0.4, 1)], axis=[float(x) for x in rng.normal(size=3)])
    elif kind == "box":
        out.update(size=[size * u(0.2, 0.7) for _ in range(dim)], angle=u(0, 90))
    elif kind == "cylinder":
        axis = rng.normal(size=3) if rng.random() < 0.7 else np.eye(3)[rng.integers(3)]
        out.update(radius=size * u(0.12, 0.35), length=size * u(0.4, 1), axis=[float(x) for x in axis])
    elif kind == "layer":
        begin = u(0, 1)
        return {"shape": kind, "normal": int(rng.integers(1, dim + 1)), "from": begin, "to": begin + u(0.15, 0.7),
                "material": "i"}
    return out


def fillers(rng, kind):
    share = float(rng.uniform(0.05, 0.3))
    f = {"material": "i", "volume_fraction": share, "counting": "area"}
    if kind == "particles":
        f.update(shape="particle", size=float(rng.uniform(0.15, 0.3)), aspect_ratio=float(rng.uniform(1, 2)),
                 placement={"overlap": True} if rng.random() < 0.3 else {"gap": 0.02})
    else:
        f.update(shape="platelet", thickness=float(rng.uniform(0.06, 0.1)), length=float(rng.uniform(0.3, 0.5)))
        f["volume_fraction"] = min(share, 0.25)
    return [f]


def picture(rng, n):
    """Level set of a few random waves, as voxels."""
    x, y = np.meshgrid(*(2 * np.pi * (np.arange(n) + 0.5) / n,) * 2, indexing="ij")
    z = sum(rng.normal() * np.cos(i * x + j * y + rng.uniform(0, 6.28)) / (1 + i * i + j * j)
            for i in range(4) for j in range(-3, 4))
    return (z > np.quantile(z, rng.uniform(0.5, 0.85))).astype(np.uint8)


def draw(seed, dim, kind, nodes=0):
    """A case, of voxels its picture, and the contrast. @nodes: not drawn, but these."""
    rng = np.random.default_rng(seed)
    n = int(rng.choice([16, 24, 32] if dim == 2 else [8, 10, 12]))
    n = nodes or n
    contrast = float(10 ** rng.uniform(-2, 3))
    nu = [float(rng.uniform(0.05, 0.45)) for _ in range(2)]
    plane = ["generalised_strain", "strain", "stress"][rng.integers(3)]
    solids = ["disk", "ellipse", "box"] if dim == 2 else ["sphere", "ellipsoid", "cylinder", "box"]
    materials = {"m": {"E": 1.0, "nu": nu[0]}, "i": {"E": contrast, "nu": nu[1]}}
    micro = {"dimension": dim, "size": [1.0] * dim, "nodes": [n] * dim, "matrix": "m", "seed": int(seed)}
    case = {"perihom": 1, "title": f"{kind} {seed}", "units": {"length": "um", "stress": "GPa", "time": "s"},
            "materials": materials, "microstructure": micro}
    if dim == 2:
        micro["plane"] = plane
    image = None
    one = [shape(rng, str(rng.choice(solids)), dim)]
    if kind == "void":
        materials["i"] = {"void": True}
        micro["inclusions"] = one
    elif kind == "several":
        micro["inclusions"] = [shape(rng, str(rng.choice(solids)), dim, 0.6) for _ in range(int(rng.integers(2, 5)))]
    elif kind in ("particles", "platelets"):
        micro.update(fillers=fillers(rng, kind), drawn_on=[n] * dim)
    elif kind == "nodes":
        micro["inclusions"] = one
        case["model"] = {"points": "nodes", "horizon": float(rng.choice([1.5, 2, 3]))}
    elif kind == "centre":
        micro.update(inclusions=one, interface="node_centre")
    elif kind == "voxels":
        image = picture(rng, n)
        del micro["matrix"]
    elif kind == "cracks":
        micro["plane"] = str(rng.choice(["stress", "strain"]))
        n = nodes or int(rng.choice([32, 48]))
        micro["nodes"] = [n, n]
        a, at, half = float(rng.uniform(0, np.pi)), rng.uniform(0, 1, 2), float(rng.uniform(0.15, 0.35))
        d = half * np.array([np.cos(a), np.sin(a)])
        case["cracks"] = [{"from": [float(x) for x in at - d], "to": [float(x) for x in at + d]}]
        contrast = 1.0
        del materials["i"]
    elif kind == "relaxing":
        materials["m"] = {"nu": nu[0], "E": {"infinity": 1.0, "terms": [
            {"modulus": float(10 ** rng.uniform(-0.5, 1.5)), "time": float(10 ** rng.uniform(-1, 1))}
            for _ in range(int(rng.integers(1, 3)))]}}
        micro["inclusions"] = one
    else:
        micro["inclusions"] = [shape(rng, kind, dim)]
    return case, image, contrast


# ---- answers ----

def constants(effective, dim):
    out = dict(effective["engineering"])
    out.update({f"isotropic.{k}": v for k, v in effective["isotropic"].items() if k != "distance"})
    add_tensor(out, effective["stiffness"], "")
    return out


def add_tensor(out, c, where):
    index = [1, 2, 6] if len(c) == 3 else range(1, 7)
    for i, a in enumerate(index):
        for j, b in enumerate(index):
            if j >= i:
                out[f"C{a}{b}{where}"] = c[i][j]


def relaxing(document, time):
    """C(t) at these times and at last."""
    v, out = document["effective"]["viscoelastic"], {}
    last = np.array(v["stiffness_infinity"])
    for k, t in enumerate(time):
        add_tensor(out, (last + sum(np.array(x["stiffness"]) * np.exp(-t / x["time"]) for x in v["terms"])).tolist(), f"@{k}")
    add_tensor(out, last.tolist(), "@inf")
    return out


def bars_of(document):
    q = document["quality"]
    bars = {k: v for k, v in q["error_bar"].items() if v is not None}
    v = document["effective"].get("viscoelastic")
    if v and v["error_bar"]:
        bars.update({f"{k}@inf": b for k, b in v["error_bar"]["infinity"].items() if b is not None and k[0] == "C"})
        for name, column in v["error_bar"]["curves"].items():
            if name[0] == "C":
                bars.update({f"{name}@{k}": b for k, b in enumerate(column) if b is not None})
    return bars


class Solver:
    def __init__(self, perihom, folder):
        self.perihom, self.folder = perihom, Path(folder)

    def __call__(self, case, image, times, bars):
        case = json.loads(json.dumps(case))
        n = case["microstructure"]["nodes"][0] * times
        case["microstructure"]["nodes"] = [n] * case["microstructure"]["dimension"]
        case["error_bar"] = "auto" if bars else "none"
        case["solver"] = {"max_iterations": 5000}
        if image is not None:
            np.save(self.folder / "image.npy", np.kron(image, np.ones((times, times), np.uint8)))
            case["microstructure"]["voxels"] = {"file": "image.npy", "materials": ["m", "i"]}
        (self.folder / "case.yaml").write_text(json.dumps(case))
        done = subprocess.run([self.perihom, "run", "case.yaml", "-o", "out", "--force", "--json", "-q", "-j", "1"],
                              cwd=self.folder, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise RuntimeError(done.stderr.strip()[:300])
        return json.loads(done.stdout)


def finer(dim, n, kind):
    """The two grids of the reference, as multiples."""
    if kind == "cracks":
        return [4, 8] if n <= 32 else [3, 6]
    if dim == 3:
        return [2, 4]
    return [6, 12] if n <= 24 else [4, 8]


def study(solve, seed, dim, kind):
    case, image, contrast = draw(seed, dim, kind)
    n = case["microstructure"]["nodes"][0]
    first = solve(case, image, 1, True)
    row = {"seed": seed, "class": kind, "dimension": dim, "nodes": n, "contrast": contrast, "constants": {}}
    bars, grids = bars_of(first), finer(dim, n, kind)
    fine = [solve(case, image, m, False) for m in grids]
    values = [constants(x["effective"], dim) for x in [first] + fine]
    if "viscoelastic" in first["effective"]:
        times = first["effective"]["viscoelastic"]["error_bar"]["curves"]["time"]
        for v, x in zip(values, [first] + fine):
            v.update(relaxing(x, times))
    parts, better = first["quality"]["error_parts"], first["quality"]["richardson"]
    for name, bar in bars.items():
        value, a, b = (v[name] for v in values)
        ratio = grids[1] / grids[0]
        truth = b + (b - a) / (ratio - 1)
        row["constants"][name] = [value, bar, truth, abs(truth - b), better.get(name)] + [
            (parts[p] or {}).get(name) for p in ("discretisation", "stabilisation", "geometry", "solver")]
    row["cost"] = {k: first["cost"]["error_bar"][k] for k in ("seconds", "applications")}
    row["cost"]["case"] = first["cost"]["seconds"]
    row["why"] = sorted(set(r for p, r in first["reasons"].items() if p.startswith("quality.error_bar.")))
    return row


def run(a):
    path = Path(a.rows)
    done = {json.loads(l)["seed"] for l in path.read_text().splitlines()} if path.exists() else set()
    with tempfile.TemporaryDirectory() as folder, path.open("a") as out:
        solve = Solver(str(Path(a.perihom).resolve()), folder)
        for i in range(a.first, a.cases):
            dim, kind = CLASSES[i % len(CLASSES)]
            seed = a.seed + i
            if seed in done:
                continue
            try:
                row = study(solve, seed, dim, kind)
            except (RuntimeError, KeyError, TypeError) as e:
                row = {"seed": seed, "class": kind, "dimension": dim, "failed": repr(e)[:300]}
            out.write(json.dumps(row) + "\n")
            out.flush()


def renew(a):
    """The bars of all rows by another program, against the references that are there."""
    path = Path(a.rows)
    rows = [json.loads(l) for l in path.read_text().splitlines()]
    with tempfile.TemporaryDirectory() as folder:
        solve = Solver(str(Path(a.perihom).resolve()), folder)
        for row in rows:
            if "failed" in row:
                continue
            case, image, contrast = draw(row["seed"], row["dimension"], row["class"], row["nodes"])
            if contrast != row["contrast"]:
                sys.exit(f"seed {row['seed']} draws another case than it did")
            first = solve(case, image, 1, True)
            bars, parts, better = bars_of(first), first["quality"]["error_parts"], first["quality"]["richardson"]
            for name, c in row["constants"].items():
                c[1] = bars.get(name, c[1])
                c[4] = better.get(name)
                c[5:] = [(parts[p] or {}).get(name) for p in ("discretisation", "stabilisation", "geometry", "solver")]
            row["cost"] = {k: first["cost"]["error_bar"][k] for k in ("seconds", "applications")}
            row["cost"]["case"] = first["cost"]["seconds"]
    path.write_text("".join(json.dumps(r) + "\n" for r in rows))


# ---- the page ----

EXACT = 1e-8  # what differs by less is exact on both grids, but for the solver


def without_geometry(c):
    """Random fillers: the reference is the same realisation, not the content that was asked for."""
    d, s, _, solver = (x or 0.0 for x in c[5:])
    return float(np.hypot(d, s)) + solver


def collect(rows):
    """class -> list of (error, bar, error of richardson or nan, uncertainty of the reference)."""
    out = {}
    for r in rows:
        name = f"{r['dimension']}D {r['class']}"
        for c in r["constants"].values():
            size = abs(c[0])
            bar = without_geometry(c) if r["class"] in ("particles", "platelets") else c[1]
            better = abs(c[4] - c[2]) / size if c[4] is not None else float("nan")
            out.setdefault(name, []).append((abs(c[0] - c[2]) / size, bar, better, c[3] / size))
    return {k: np.array(v) for k, v in out.items()}


def line(name, cases, v):
    e = v[v[:, 0] > EXACT]
    held = np.mean(e[:, 0] <= e[:, 1]) if len(e) else 1.0
    cells = [name, str(cases), str(len(e)), f"{100 * held:.1f}" if len(e) else "-"]
    cells += [f"{np.median(e[:, 0]):.1e}", f"{np.median(e[:, 1] / e[:, 0]):.1f}"] if len(e) else ["exact", "-"]
    return "| " + " | ".join(cells) + " |"


def figure(v, path):
    """Bar against error, log-log, as SVG."""
    lo, hi, w = -6.0, 1.0, 420
    def at(x):
        return 50 + (np.clip(np.log10(x), lo, hi) - lo) / (hi - lo) * w
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{w + 70}" height="{w + 70}" font-family="sans-serif" font-size="12">',
           f'<rect width="{w + 70}" height="{w + 70}" fill="white"/>']
    for k in range(int(lo), int(hi) + 1):
        p = at(10.0 ** k)
        out.append(f'<path d="M{p:.1f} 20V{20 + w}M50 {w + 70 - p:.1f}H{50 + w}" stroke="#ddd"/>'
                   f'<text x="{p:.1f}" y="{w + 36}" text-anchor="middle">1e{k}</text>'
                   f'<text x="46" y="{w + 74 - p:.1f}" text-anchor="end">1e{k}</text>')
    e = v[v[:, 0] > 10 ** lo]
    for x, y, *_ in e[:: max(1, len(e) // 2500)]:
        out.append(f'<circle cx="{at(x):.1f}" cy="{w + 70 - at(y):.1f}" r="1.5" fill="{"#1f77b4" if x <= y else "#d62728"}" fill-opacity="0.5"/>')
    out.append(f'<path d="M50 {20 + w}L{50 + w} 20" stroke="black"/>'
               f'<text x="{50 + w / 2}" y="{w + 58}" text-anchor="middle">error, relative</text>'
               f'<text transform="translate(12 {20 + w / 2}) rotate(-90)" text-anchor="middle">error bar, relative</text></svg>')
    path.write_text("\n".join(out) + "\n")


def table(a):
    rows = [json.loads(l) for l in Path(a.rows).read_text().splitlines()]
    good = [r for r in rows if "failed" not in r and r["constants"]]
    none = [r for r in rows if "failed" not in r and not r["constants"]]
    classes, counts = collect(good), {}
    for r in good:
        k = f"{r['dimension']}D {r['class']}"
        counts[k] = counts.get(k, 0) + 1
    print("| class | cases | constants | held, % | median error | median bar / error |\n|---|---|---|---|---|---|")
    for k in sorted(classes):
        print(line(k, counts[k], classes[k]))
    whole = np.concatenate(list(classes.values()))
    print(line("**all**", len(good), whole))
    e = whole[whole[:, 0] > EXACT]
    better = e[np.isfinite(e[:, 2])]
    worst = max((abs(c[0] - c[2]) / abs(c[0]) for r in good for c in r["constants"].values()
                 if abs(c[0] - c[2]) / abs(c[0]) <= EXACT), default=0)
    print(f"\n{len(rows) - len(good) - len(none)} failed, {len(none)} without bars; {len(whole) - len(e)} constants exact (worst {worst:.1e}, "
          f"widest bar {max(whole[whole[:, 0] <= EXACT][:, 1], default=0):.1e})")
    print(f"richardson / raw error, median {np.median(better[:, 2] / better[:, 0]):.2f}, better in {100 * np.mean(better[:, 2] < better[:, 0]):.0f} %")
    print(f"reference uncertain by more than a third of the error: {100 * np.mean(e[:, 3] > e[:, 0] / 3):.1f} % of constants; "
          f"without them held {100 * np.mean((e[:, 0] <= e[:, 1])[e[:, 3] <= e[:, 0] / 3]):.1f} %, "
          f"median {np.median((e[:, 1] / e[:, 0])[e[:, 3] <= e[:, 0] / 3]):.1f}")
    for d in (2, 3):
        share = [r["cost"]["seconds"] / r["cost"]["case"] for r in good if r["dimension"] == d and r["class"] != "layer"]
        if share:
            print(f"{d}D: seconds of the companion over those of the case, median {np.median(share):.2f}")
    figure(whole, ROOT / "docs/pictures/error-bars.svg")


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    sub = p.add_subparsers(required=True)
    for name, do in (("run", run), ("bars", renew), ("table", table)):
        r = sub.add_parser(name)
        if name != "table":
            r.add_argument("perihom")
        r.add_argument("rows")
        if name == "run":
            r.add_argument("--first", type=int, default=0)
            r.add_argument("--cases", type=int, default=352)
            r.add_argument("--seed", type=int, default=5000)
        r.set_defaults(do=do)
    a = p.parse_args()
    a.do(a)


main()
