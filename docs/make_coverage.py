#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Do error bars hold the truth? Random cases, solved with their bars and on much finer grids.

usage: make_coverage.py run PERIHOM ROWS.jsonl [--first 0] [--cases 352] [--seed 5000]
       make_coverage.py table ROWS.jsonl          (table and figure of docs/validation/error-bars.md)

Needs python3-numpy. A row a case, which is written when it is done: a run that was stopped goes on.
The factors of the bars were found on seeds 1000 to 1399 (of an earlier form of this script).
"""
import argparse
import json
import subprocess
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


def draw(seed, dim, kind):
    """A case and, of voxels, its picture."""
    rng = np.random.default_rng(seed)
    n = int(rng.choice([16, 24, 32, 48] if dim == 2 else [8, 12, 16]))
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
        n = micro["nodes"][0] = int(rng.choice([32, 48]))
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
        case["solver"] = {"tolerance": 1e-6 if bars else 1e-7, "max_iterations": 5000}
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
    return [8, 16] if n <= 24 else [4, 8]


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


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    sub = p.add_subparsers(required=True)
    r = sub.add_parser("run")
    r.add_argument("perihom")
    r.add_argument("rows")
    r.add_argument("--first", type=int, default=0)
    r.add_argument("--cases", type=int, default=352)
    r.add_argument("--seed", type=int, default=5000)
    r.set_defaults(do=run)
    a = p.parse_args()
    a.do(a)


main()
