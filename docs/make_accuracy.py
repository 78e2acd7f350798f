#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What accuracy costs: random cases, their references, what `trade` finds and what automatic fidelity does.

usage: make_accuracy.py PERIHOM FOLDER COUNT [SEED]

Writes FOLDER/case-I.yaml, and FOLDER/study.jsonl with one line a case: the reference of its fine grids and every row of
`perihom trade` against it, then what `accuracy: {relative: 0.03, 0.01, 0.003}` did. Lines that are there are not made again.
"""
import json
import math
import os
import random
import subprocess
import sys
from pathlib import Path

TARGETS = (0.03, 0.01, 0.003)


def material(rng, E):
    return f"{{E: {E:.6g}, nu: {rng.uniform(0.1, 0.42):.4f}}}"


def inclusion(rng, dim, biggest):
    centre = ", ".join(f"{rng.random():.5f}" for _ in range(dim))
    r = rng.uniform(0.08, biggest)
    if dim == 3:
        if rng.random() < 0.6:
            return f"shape: sphere, centre: [{centre}], radius: {r:.5f}"
        axes = ", ".join(f"{r * rng.uniform(0.6, 1.2):.5f}" for _ in range(3))
        return f"shape: ellipsoid, centre: [{centre}], semi_axes: [{axes}]"
    kind = rng.choice(["disk", "disk", "ellipse", "box"])
    if kind == "disk":
        return f"shape: disk, centre: [{centre}], radius: {r:.5f}"
    if kind == "ellipse":
        return (f"shape: ellipse, centre: [{centre}], semi_axes: [{r:.5f}, {r * rng.uniform(0.35, 0.9):.5f}], "
                f"angle: {rng.uniform(0, 180):.2f}")
    return (f"shape: box, centre: [{centre}], size: [{2 * r:.5f}, {2 * r * rng.uniform(0.35, 0.9):.5f}], "
            f"angle: {rng.uniform(0, 90):.2f}")


def random_case(seed):
    """One to five inclusions of one or two materials; contrast 1e-2 to 1e3, log-uniform; a fifth in 3D."""
    rng = random.Random(seed)
    dim = 3 if rng.random() < 0.2 else 2
    plane = "" if dim == 3 else f"  plane: {rng.choice(['generalised_strain', 'strain', 'stress'])}\n"
    count = rng.randint(1, 5 if dim == 2 else 3)
    biggest = 0.4 / math.sqrt(count) + 0.04
    materials = {"matrix": material(rng, 1.0)}
    for k in range(rng.randint(1, 2)):
        materials[f"filler{k}"] = material(rng, 10 ** rng.uniform(-2, 3))
    names = [m for m in materials if m != "matrix"]
    text = f"perihom: 1\ntitle: Random cell {seed}\nmaterials:\n"
    text += "".join(f"  {name}: {m}\n" for name, m in materials.items())
    text += f"microstructure:\n  dimension: {dim}\n{plane}  size: [{', '.join(['1.0'] * dim)}]\n"
    text += f"  nodes: [{', '.join(['32'] * dim)}]\n  matrix: matrix\n  inclusions:\n"
    for _ in range(count):
        text += f"    - {{{inclusion(rng, dim, biggest)}, material: {rng.choice(names)}}}\n"
    return text, dim


def perihom(program, *words):
    done = subprocess.run([program, *words], capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


def cpu_of(program, *words):
    """CPU seconds of a command with its start and its files, least of three where it is short."""
    best = math.inf
    for _ in range(3):
        child = subprocess.Popen([program, *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        _, _, used = os.wait4(child.pid, 0)
        best = min(best, used.ru_utime + used.ru_stime)
        if best > 0.2:
            break
    return best


def commands(program, folder, path, found, target, seed):
    """Both as a user runs them: the accuracy, with its error bars; the best setting, without."""
    row = next(a["row"] for a in found["advice"] if abs(a["accuracy"] - target) < 1e-9)
    if row is None:
        return {}
    words = [str(path), "-q", "-j", "1", "-o", str(folder / "best"), "--force", "--set", "error_bar=none"]
    for item in found["rows"][row]["set"]:
        words += ["--set", item]
    auto = folder / f"auto-{seed}-{target}.yaml"
    return {"cpu": cpu_of(program, "run", str(auto), "-q", "-j", "1", "-o", str(folder / "auto"), "--force"),
            "best_cpu": cpu_of(program, "run", *words)}


def trade(program, path, *words):
    code, out, err = perihom(program, "trade", str(path), "-q", "--json", "-o", str(path.with_suffix("")), *words)
    if code:
        raise RuntimeError(f"{path}: {err}")
    return json.loads(out)


def study(program, folder, seed):
    text, dim = random_case(seed)
    path = folder / f"case-{seed}.yaml"
    path.write_text(text)
    fine = trade(program, path, "--knobs", "nodes", "--finest", "256" if dim == 2 else "48")
    values = fine["reference"]["values"]
    given = ",".join(f"{k}={v!r}" for k, v in values.items())
    found = trade(program, path, "--knobs", "nodes,points,interface,model,tolerance", "--reference", given,
                  "--finest", "96" if dim == 2 else "24")
    rows = found["rows"] + fine["rows"]
    return {"seed": seed, "dimension": dim, "reference": values, "reference_error": fine["reference"]["error"],
            "advice": found["advice"], "rows": rows,
            "fidelity": [fidelity(program, folder, text, t, seed) | {"command": commands(program, folder, path, found, t, seed)}
                         for t in TARGETS if fine["reference"]["error"] <= t / 2]}


def fidelity(program, folder, text, target, seed):
    """`perihom run` with an accuracy in place of nodes."""
    path = folder / f"auto-{seed}-{target}.yaml"
    path.write_text("".join(line for line in text.splitlines(True) if not line.startswith("  nodes:"))
                    + f"accuracy: {{relative: {target}}}\nbudget: {{seconds: 600}}\n")
    code, out, err = perihom(program, "run", str(path), "--json", "-q", "-j", "1", "-o", str(folder / "auto"), "--force")
    if code:
        return {"target": target, "code": code, "message": err}
    result = json.loads(out)
    return {"target": target, "code": 0, "fidelity": result["fidelity"], "engineering": result["effective"]["engineering"]}


def main():
    program, folder, count = sys.argv[1], Path(sys.argv[2]), int(sys.argv[3])
    first = int(sys.argv[4]) if len(sys.argv) > 4 else 1
    folder.mkdir(parents=True, exist_ok=True)
    lines = folder / "study.jsonl"
    there = {json.loads(line)["seed"] for line in lines.read_text().splitlines()} if lines.exists() else set()
    with lines.open("a") as out:
        for seed in range(first, first + count):
            if seed in there:
                continue
            out.write(json.dumps(study(program, folder, seed)) + "\n")
            out.flush()


if __name__ == "__main__":
    main()
