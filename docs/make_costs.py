#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures and tables of docs/accuracy-costs.md.

usage: make_costs.py collect SCENE=TRADE.json...    rows of sweeps into docs/accuracy-costs.jsonl
       make_costs.py study STUDY.jsonl              random cases of make_accuracy.py into docs/accuracy-study.jsonl
       make_costs.py                                figures and tables from these files   (needs python3-matplotlib)

Peers: dolfinx as measured in docs/performance.jsonl; FANS and sfepy by data/reference/peers.csv, times the ratio
of dolfinx's seconds there and then. Their errors are those of their tensors against the same reference.
"""
import csv
import json
import math
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
ROWS, STUDY, PAGE = (ROOT / "docs" / n for n in ("accuracy-costs.jsonl", "accuracy-study.jsonl", "accuracy-costs.md"))
SCENES = {"fibre": "Fibre composite", "sphere": "Sphere composite", "clay": "Clay nanocomposite", "crack": "Cracked cell",
          "visco": "Viscoelastic cell"}
TARGETS = (0.03, 0.01, 0.003)
# C11, C12, C_shear of the peers' problems: this script's scenes have the same cells
PEER_PROBLEM = {"fibre": "P2", "sphere": "SC"}


def family(row):
    words = " ".join(w for w in row["set"] if not w.startswith("microstructure.nodes"))
    if row["knob"] != "grid":
        return "other knobs"
    for key, name in (("crack_tips", "crack tips cut shorter"), ("kind=local", "finite elements"),
                      ("node_centre", "interface by node centre"), ("points=nodes", "at the nodes")):
        if key in words:
            return name
    return "as the case"


def collect(arguments):
    with ROWS.open("w") as out:
        for scene, path in (a.split("=") for a in arguments):
            d = json.loads(Path(path).read_text())
            best = {}
            for a in d["advice"]:
                if a["row"] is not None:
                    best.setdefault(a["row"], []).append(a["accuracy"])
            out.write(json.dumps({"scene": scene, "reference": d["reference"], "complete": d["complete"]}) + "\n")
            for i, r in enumerate(d["rows"]):
                if r["state"] != "done" or r["error"] is None:
                    continue
                out.write(json.dumps({
                    "scene": scene, "family": family(r), "knob": r["knob"], "set": r["set"], "nodes": r["nodes"],
                    "realisations": r["realisations"], "error": round(r["error"], 9), "cpu": round(r["cost"]["cpu_seconds"], 7),
                    "work": round(r["cost"]["work"]), "bytes": r["cost"]["peak_bytes"], "front": r["front"],
                    "advised": best.get(i, [])}) + "\n")


def error_of(value, reference, name):
    size = max(abs(reference), 0.1) if name.startswith("nu") else abs(reference)
    return abs(value - reference) / size


def study(path):
    """One line a case and accuracy: true error, estimate, operations beside those of the best setting."""
    with STUDY.open("w") as out:
        for line in Path(path).read_text().splitlines():
            c = json.loads(line)
            for f in c["fidelity"]:
                advice = next(a for a in c["advice"] if abs(a["accuracy"] - f["target"]) < 1e-9)
                best = c["rows"][advice["row"]]["cost"] if advice["row"] is not None else None
                command = f.get("command", {})
                row = {"seed": c["seed"], "command_cpu": command.get("cpu"), "best_command_cpu": command.get("best_cpu"), "dimension": c["dimension"], "target": f["target"],
                       "reference_error": c["reference_error"], "code": f["code"],
                       "best_operations": best and best["work"], "best_cpu": best and best["cpu_seconds"],
                       "same_operations": same_family(c["rows"], f["target"])}
                if f["code"] == 0:
                    engineering, a = f["engineering"], f["fidelity"]
                    row |= {"error": max(error_of(engineering[k], v, k) for k, v in c["reference"].items()),
                            "estimate": a["error"], "operations": a["operations"], "steps": len(a["steps"]),
                            "cpu": a.get("cpu_seconds"), "nodes": a["chosen"]["microstructure.nodes"][0]}
                out.write(json.dumps(row) + "\n")


def same_family(rows, target):
    """Operations of the cheapest grid and tolerance with stress points and composite cells whose finer grids are good too."""
    mine = {}
    for r in rows:
        words = [w for w in r["set"] if not w.startswith(("microstructure.nodes", "solver.tolerance"))]
        if r["state"] == "done" and r["knob"] == "grid" and not words:
            tolerance = next((w for w in r["set"] if w.startswith("solver.tolerance")), "")
            mine.setdefault(tolerance, []).append(r)
    good = [r["cost"]["work"] for many in mine.values() for r in many
            if r["error"] <= target and all(o["error"] <= target for o in many if o["nodes"] > r["nodes"])]
    return min(good) if good else None


def table(head, rows):
    return ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)] + ["| " + " | ".join(map(str, r)) + " |" for r in rows]


def number(x, digits=2):
    return "" if x is None else f"{x:.{digits}g}"


def peers(scene, reference):
    """{name: [(cpu, error, n)]} of the codes that solved this cell."""
    problem = PEER_PROBLEM.get(scene)
    if not problem:
        return {}
    names = {"C11": "C11", "C12": "C12", "C_shear": "C66" if problem == "P2" else "C44"}
    now = {}
    for line in (ROOT / "docs/performance.jsonl").read_text().splitlines():
        r = json.loads(line)
        if r["bench"] == "peer" and r["problem"] == problem:
            error = max(abs(r[k] / reference[v] - 1) for k, v in names.items())
            if r["n"] not in now or r["cpu"] < now[r["n"]][0]:
                now[r["n"]] = (r["cpu"], error, r["n"])
    lines = [l for l in (ROOT / "data/reference/peers.csv").read_text().splitlines() if l[0] != "#"]
    then = list(csv.DictReader(lines))
    dolfinx = {(p["problem"], int(p["n"])): float(p["cpu"]) for p in then if p["peer"] == "dolfinx"}
    scale_by = "P2" if problem == "P2" else "P3"
    seconds = {}
    for line in (ROOT / "docs/performance.jsonl").read_text().splitlines():
        r = json.loads(line)
        if r["bench"] == "peer" and r["problem"] == scale_by:
            seconds[r["n"]] = min(r["cpu"], seconds.get(r["n"], math.inf))
    ratios = [seconds[n] / dolfinx[scale_by, n] for n in seconds if (scale_by, n) in dolfinx]
    slower = sum(ratios) / len(ratios)
    out = {"dolfinx": sorted(now.values())}
    if problem == "SC":
        out["FANS"] = [(float(p["cpu"]) * slower, max(float(p[k]) for k in ("error_C11", "error_C12", "error_C44")) / 100,
                        int(p["n"])) for p in then if p["problem"] == "SC"]
    else:  # the same trilinear or bilinear cells: the same tensors as dolfinx, to the digits that each prints
        out["sfepy"] = [(float(p["cpu"]) * slower, now[int(p["n"])][1], int(p["n"])) for p in then
                        if p["problem"] == "P2" and p["peer"] == "sfepy" and int(p["n"]) in now]
        fans = {100: 0.25, 200: 0.99, 400: 4.4}  # two layers of voxels, solver's own CPU seconds, same day as peers.csv
        out["FANS, two layers"] = [(s * slower, now[n][1], n) for n, s in fans.items() if n in now]
    return out


COLOURS = {"as the case": "#0072b2", "at the nodes": "#56b4e9", "interface by node centre": "#e69f00", "finite elements": "#009e73",
           "crack tips cut shorter": "#cc79a7", "other knobs": "#999999"}


def figure(scene, head, rows):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    plt.rcParams["svg.hashsalt"] = "perihom"
    fig, ax = plt.subplots(figsize=(7.5, 4.8))
    rows = [r for r in rows if r["realisations"] == 1 and r["knob"] not in ("threads", "constraint")]
    for name, colour in COLOURS.items():
        mine = [r for r in rows if r["family"] == name]
        if mine:
            ax.loglog([r["cpu"] for r in mine], [100 * max(r["error"], 1e-6) for r in mine], ".", ms=4, color=colour, label=name)
    front = sorted((r["work"], r["cpu"], r["error"]) for r in rows if r["front"] and r["cpu"] > 0)
    ax.loglog([r[1] for r in front], [100 * max(r[2], 1e-6) for r in front], "-", lw=0.8, color="#333333", label="front, by operations")
    for mark, (name, points) in zip("s^D", peers(scene, head["reference"]["values"]).items()):
        ax.loglog([p[0] for p in points], [100 * p[1] for p in points], mark + "-", color="#d55e00", ms=6, lw=1, mfc="none", label=name)
        for p in points:
            ax.annotate(f"{p[2]}", (p[0], 100 * p[1]), textcoords="offset points", xytext=(5, 4), fontsize=8, color="#d55e00")
    if head["reference"]["error"]:
        ax.axhline(100 * head["reference"]["error"], color="#cccccc", lw=0.8)
    ax.set_xlabel("CPU seconds")
    ax.set_ylabel("worst error of the constants [%]")
    ax.set_title(SCENES[scene])
    ax.grid(True, which="both", alpha=0.2)
    ax.legend(fontsize=8)
    fig.tight_layout()
    fig.savefig(ROOT / f"docs/pictures/costs-{scene}.svg", metadata={"Date": None})
    plt.close(fig)


def scene_table(head, rows):
    out = []
    for t in TARGETS:
        r = next((r for r in rows if t in r["advised"]), None)
        what = " ".join(w for w in r["set"] if "drawn_on" not in w) if r else "nothing of the sweep"
        out.append([f"{100 * t:g} %"] + ([f"`{what}`", f"{100 * r['error']:.2g} %", number(r["work"]), number(r["cpu"])] if r
                                         else [what, "", "", ""]))
    return table(["accuracy", "cheapest setting", "error", "operations", "CPU s"], out)


def rve_table(rows):
    return table(["edge", "realisations", "error", "operations", "CPU s"],
                 [[next(w for w in r["set"] if ".size" in w).split("=")[1], r["realisations"], f"{100 * r['error']:.2g} %",
                   number(r["work"]), number(r["cpu"])] for r in rows])


def peers_table(heads, all_rows):
    out = []
    for scene in PEER_PROBLEM:
        for name, points in peers(scene, heads[scene]["reference"]["values"]).items():
            for cpu, error, n in points:
                good = [r for r in all_rows[scene] if r["error"] <= error and r["knob"] == "grid" and r["cpu"] > 0]
                best = min(good, key=lambda r: r["work"])
                out.append([SCENES[scene], f"{name}, {n}", f"{100 * error:.2g} %", number(cpu, 3), number(best["cpu"]),
                            number(cpu / best["cpu"])])
    return table(["cell", "code, nodes an axis", "error", "CPU s", "perihom at this error, CPU s", "ratio"], out)


def median(x):
    x = sorted(x)
    return (x[(len(x) - 1) // 2] + x[len(x) // 2]) / 2 if x else None


def study_table(rows):
    out = []
    for t in TARGETS:
        mine = [r for r in rows if abs(r["target"] - t) < 1e-9]
        solved = [r for r in mine if r["code"] == 0]
        good = sum(r["error"] <= t for r in solved)
        ratio = {k: [r[a] / r[b] for r in solved if r[a] and r[b]] for k, a, b in (
            ("operations", "operations", "best_operations"), ("cpu", "cpu", "best_cpu"), ("same", "operations", "same_operations"),
            ("command", "command_cpu", "best_command_cpu"))}
        cell = lambda x: f"{number(median(x))} ({100 * sum(v <= 2 for v in x) / len(x):.0f} %)" if x else ""
        out.append([f"{100 * t:g} %", len(mine), f"{good} ({100 * good / len(mine):.0f} %)" if mine else "",
                    number(median([r["error"] / t for r in solved])), number(median([r["cpu"] for r in solved if r["cpu"]])), cell(ratio["operations"]), cell(ratio["same"]), cell(ratio["cpu"]), cell(ratio["command"])])
    return table(["accuracy", "cases", "within it", "error over accuracy, median", "CPU s, median", "operations over the best setting's, median (at most 2)",
                  "over the best with the same points and interface", "CPU seconds over the best setting's",
                  "the same of the whole command"], out)


def put(text, name, lines):
    return re.sub(rf"(<!-- table: {name} -->\n).*?(<!-- end -->)", lambda m: m.group(1) + "\n".join(lines) + "\n" + m.group(2), text, flags=re.S)


def draw():
    heads, rows, text = {}, {}, PAGE.read_text()
    for line in ROWS.read_text().splitlines():
        r = json.loads(line)
        if "reference" in r:
            heads[r["scene"]] = r
        else:
            rows.setdefault(r["scene"], []).append(r)
    for scene, head in heads.items():
        figure(scene, head, rows[scene])
        text = put(text, scene, scene_table(head, rows[scene]))
    text = put(text, "peers", peers_table(heads, rows))
    text = put(text, "rve", rve_table([r for r in rows["clay"] if r["knob"] == "rve"]))
    if STUDY.exists():
        text = put(text, "study", study_table([json.loads(l) for l in STUDY.read_text().splitlines()]))
    PAGE.write_text(text)


if __name__ == "__main__":
    if sys.argv[1:2] == ["collect"]:
        collect(sys.argv[2:])
    elif sys.argv[1:2] == ["study"]:
        study(sys.argv[2])
    else:
        draw()
