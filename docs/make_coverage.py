#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Do error bars hold the truth? Random cases with their bars, and the same on much finer grids.

usage: make_coverage.py run PERIHOM [--cases 308] [--seed 40000]   references, into docs/coverage.jsonl
       make_coverage.py page PERIHOM [--keep ROWS.jsonl]          bars of this program against them: page and picture

Needs python3-numpy. Every case is drawn from its seed; the file has a line a case with what finer grids give, which
takes a quarter of an hour of CPU and is there. A run that was stopped goes on. `page` solves the cases themselves, two
minutes of CPU, and writes the tables of docs/validation/error-bars.md: ninja -C build error_bars.
"""
import argparse
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/validation/error-bars.md"
NAN = float("nan")
EXACT = 1e-8  # what differs by less is exact on both grids, but for the solver
PLANE = ["disk", "ellipse", "box", "layer", "several", "particles", "platelets", "void", "nodes", "centre", "voxels",
         "odd voxels", "cracks", "relaxing"]
SPACE = ["sphere", "ellipsoid", "cylinder", "box", "layer", "several", "particles", "void", "centre"]
# the last four once more: bars held them less often than others, once
CLASSES = [(2, c) for c in PLANE] + [(3, c) for c in SPACE] + [(2, "disk"), (2, "box"), (2, "cracks"), (3, "void")]
ODD = {16: 15, 24: 21, 32: 25}


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
    n = nodes or (ODD[n] if kind == "odd voxels" else n)
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
    elif kind in ("voxels", "odd voxels"):
        image = picture(rng, n)
        del micro["matrix"]
    elif kind == "cracks":
        micro["plane"] = str(rng.choice(["stress", "strain"]))
        n = int(rng.choice([32, 48]))  # drawn whether it is given or not: what follows is the same
        n = nodes or n
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

def constants(effective):
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


def bars_of(document, times):
    """name -> (value, bar, extrapolated value or nan, the bar but for the share of fillers). Of C(t) at these times, its bars
    between those of the result."""
    q = document["quality"]
    parts, value = q["error_parts"], constants(document["effective"])
    def rest(name):
        d, s, solver = ((parts[p] or {}).get(name, 0.0) for p in ("discretisation", "stabilisation", "solver"))
        return min(float(np.hypot(d, s)) + solver, q["error_bar"][name])
    out = {k: (value[k], b, q["richardson"].get(k, NAN), rest(k)) for k, b in q["error_bar"].items() if b is not None}
    v = document["effective"].get("viscoelastic")
    if v and v["error_bar"]:
        curves = dict(v["error_bar"]["curves"])
        own, value = np.log(curves.pop("time")), relaxing(document, times)
        late = {f"{k}@inf": b for k, b in v["error_bar"]["infinity"].items()}
        for name, column in curves.items():
            if None not in column:
                late.update({f"{name}@{k}": float(b) for k, b in enumerate(np.interp(np.log(times), own, column))})
        out.update({k: (value[k], b, NAN, b) for k, b in late.items() if b is not None and k[0] == "C"})
    return out


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
    if dim == 3:
        return [2, 4]
    return [4, 8] if n <= 24 and kind != "cracks" else [3, 6]


def times_of(document):
    v = document["effective"].get("viscoelastic")
    return v["error_bar"]["curves"]["time"] if v else None


def reference(solve, seed, dim, kind):
    """What two finer grids give, extrapolated at first order, and how far the finer of them is from that."""
    case, image, contrast = draw(seed, dim, kind)
    n = case["microstructure"]["nodes"][0]
    grids = finer(dim, n, kind)
    row = {"seed": seed, "class": kind, "dimension": dim, "nodes": n, "contrast": contrast}
    times = times_of(solve(case, image, 1, True)) if kind == "relaxing" else None
    if times:
        row["times"] = times
    values = []
    for x in (solve(case, image, m, False) for m in grids):
        values.append(constants(x["effective"]))
        if times:
            values[-1].update(relaxing(x, times))
    row["truth"] = {}
    for name, fine in values[1].items():
        if fine is None or values[0][name] is None:
            continue
        truth = fine + (fine - values[0][name]) / (grids[1] / grids[0] - 1)
        row["truth"][name] = [float(f"{truth:.11g}"), float(f"{abs(truth - fine):.3g}")]
    return row


def lines_of(path):
    return [json.loads(x) for x in Path(path).read_text().splitlines()] if Path(path).exists() else []


def run(a):
    done = {r["seed"] for r in lines_of(a.references)}
    with tempfile.TemporaryDirectory() as folder, Path(a.references).open("a") as out:
        solve = Solver(str(Path(a.perihom).resolve()), folder)
        for i in range(a.cases):
            dim, kind = CLASSES[i % len(CLASSES)]
            seed = a.seed + i
            if seed in done:
                continue
            try:
                row = reference(solve, seed, dim, kind)
            except (RuntimeError, KeyError, TypeError) as e:
                row = {"seed": seed, "class": kind, "dimension": dim, "failed": repr(e)[:300]}
            out.write(json.dumps(row) + "\n")
            out.flush()


def judge(solve, row):
    """name -> [value, bar, truth, uncertainty of the truth, extrapolated, bar but for the share of fillers]."""
    case, image, contrast = draw(row["seed"], row["dimension"], row["class"], row["nodes"])
    if contrast != row["contrast"]:
        sys.exit(f"seed {row['seed']} draws another case than it did")
    document = solve(case, image, 1, True)
    kept = dict(row)
    truth = kept.pop("truth")
    kept["constants"] = {k: [v, bar, *truth[k], better, rest] for k, (v, bar, better, rest) in bars_of(document, row.get("times")).items() if k in truth}
    cost = document["cost"]
    kept["cost"] = [cost["error_bar"]["seconds"], cost["seconds"]]
    return kept


# ---- the page ----

def collect(rows):
    """class -> list of (error, bar, error of the extrapolated value or nan, uncertainty of the reference)."""
    out = {}
    for r in rows:
        for value, bar, truth, unknown, better, rest in r["constants"].values():
            # random fillers: the reference is the same realisation, not the content that was asked for
            kept = rest if r["class"] in ("particles", "platelets") else bar
            out.setdefault(f"{r['dimension']}D {r['class']}", []).append(
                (abs(value - truth) / abs(value), kept, abs(better - truth) / abs(value), unknown / abs(value)))
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


def table(rows, classes):
    counts = {k: sum(f"{r['dimension']}D {r['class']}" == k for r in rows) for k in classes}
    whole = np.concatenate(list(classes.values()))
    return ["| class | cases | constants | held, % | median error | median bar / error |", "|---|---|---|---|---|---|",
            *(line(k, counts[k], classes[k]) for k in sorted(classes)), line("**all**", len(rows), whole)]


def by_case(rows, draws=2000):
    """Constants of one case hold or miss together: shares held over cases drawn with repetition, 2.5 % and 97.5 %."""
    counts = np.array([[sum(abs(c[0] - c[2]) > EXACT * abs(c[0]) for c in r["constants"].values()), 0] for r in rows])
    for i, r in enumerate(rows):
        v = collect([r])
        for x in v.values():
            counts[i, 1] = np.sum((x[:, 0] > EXACT) & (x[:, 0] <= x[:, 1]))
    rng = np.random.default_rng(1)
    shares = [k[1] / k[0] for k in (counts[rng.integers(len(rows), size=len(rows))].sum(axis=0) for _ in range(draws))]
    some = counts[counts[:, 0] > 0]
    return np.quantile(shares, [0.025, 0.975]), np.mean(some[:, 0] == some[:, 1]), np.mean(some[:, 1] / some[:, 0])


def summary(rows, failed, whole):
    e = whole[whole[:, 0] > EXACT]
    held, known = e[:, 0] <= e[:, 1], e[:, 3] <= e[:, 0] / 3
    better = e[np.isfinite(e[:, 2])]
    (low, high), all_held, mean_held = by_case(rows)
    missed = e[~held, 0] / e[~held, 1]
    yield f"{len(rows)} cases, {len(e)} constants that are not exact: **{100 * np.mean(held):.1f} %** held, median bar / error **{np.median(e[:, 1] / e[:, 0]):.1f}**."
    yield f"Resampled case by case, {100 * low:.1f} to {100 * high:.1f} % (95 %). In {100 * all_held:.0f} % of the cases all constants are held, in the mean over cases {100 * mean_held:.1f} % of them."
    yield f"Those that are missed are off by {np.median(missed):.1f} bars in the median, {np.quantile(missed, 0.95):.1f} in 95 of 100."
    yield f"Where the reference is known to better than a third of the error ({100 * np.mean(known):.0f} % of the constants), {100 * np.mean(held[known]):.1f} % are held, and the median is {np.median((e[:, 1] / e[:, 0])[known]):.1f}."
    yield f"{len(whole) - len(e)} constants are exact; the widest of their bars is {max(whole[whole[:, 0] <= EXACT][:, 1], default=0):.1e}. {failed} cases failed."
    yield f"The extrapolated value is nearer to the truth than the raw one in {100 * np.mean(better[:, 2] < better[:, 0]):.0f} % of the constants; it leaves {np.median(better[:, 2] / better[:, 0]):.2f} of the error in the median."
    for d, where in ((2, "the plane"), (3, "space")):
        share = [r["cost"][0] / r["cost"][1] for r in rows if r["dimension"] == d and r["class"] != "layer"]
        if share:
            yield f"Seconds of the companion over those of the case, median, in {where}: {np.median(share):.2f}."


def page(a):
    rows = lines_of(a.references)
    failed = sum("failed" in r for r in rows)
    with tempfile.TemporaryDirectory() as folder:
        solve = Solver(str(Path(a.perihom).resolve()), folder)
        rows = [judge(solve, r) for r in rows if "failed" not in r]
    rows = [r for r in rows if r["constants"]]
    if a.keep:
        Path(a.keep).write_text("".join(json.dumps(r) + "\n" for r in rows))
    classes = collect(rows)
    whole = np.concatenate(list(classes.values()))
    text = PAGE.read_text()
    for name, lines in (("classes", table(rows, classes)), ("summary", summary(rows, failed, whole))):
        new = "\n".join(lines)
        text = re.sub(rf"(<!-- table: {name} -->\n).*?(<!-- end -->)", lambda m: m[1] + new + "\n" + m[2], text, flags=re.S)
    PAGE.write_text(text)
    figure(whole, ROOT / "docs/pictures/error-bars.svg")


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    sub = p.add_subparsers(required=True)
    for name, do in (("run", run), ("page", page)):
        r = sub.add_parser(name)
        r.add_argument("perihom")
        r.add_argument("--references", default=ROOT / "docs/coverage.jsonl")
        if name == "run":
            r.add_argument("--cases", type=int, default=308)
            r.add_argument("--seed", type=int, default=40000)
        else:
            r.add_argument("--keep")
        r.set_defaults(do=do)
    a = p.parse_args()
    a.do(a)


main()
