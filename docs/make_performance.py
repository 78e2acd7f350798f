#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables and figure of docs/performance.md from a file of benchmark lines.

usage: make_performance.py MEASURED.jsonl      (needs python3-matplotlib)

MEASURED holds the JSON lines of `build/tests/bench/bench ...` and of
`tests/bench/peer_dolfinx.py ...`, run in turn in one go. Of lines that repeat a problem the
one with the least CPU time counts.
"""
import csv
import json
import re
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

ROOT = Path(__file__).resolve().parent.parent
EXACT = {"C11": 1.879899, "C12": 0.723387, "C_shear": 0.524211}


def read_measured(path):
    best = {}
    for line in Path(path).read_text().splitlines():
        row = json.loads(line)
        who = row.get("peer") or row.get("model") or row.get("points")
        key = (row["bench"], row.get("problem"), str(row["n"]), who, row.get("route"), row.get("horizon"),
               row.get("contrast"), row.get("tolerance"))
        cost = row.get("cpu", row.get("ns_per_node", row.get("wall_2", 0)))
        if key not in best or cost < best[key][0]:
            best[key] = (cost, row)
    return [row for _, row in best.values()]


def read_peers():
    lines = [l for l in (ROOT / "data/reference/peers.csv").read_text().splitlines() if l[0] != "#"]
    return list(csv.DictReader(lines))


def table(head, rows):
    out = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return out + ["| " + " | ".join(str(c) for c in row) + " |" for row in rows]


def number(x, digits=3):
    return f"{x:.{digits}g}"


def solves(rows, problem, who):
    return {r["n"]: r for r in rows if r.get("problem") == problem and r["bench"] in ("solve", "peer")
            and who in (r.get("peer"), r.get("model"))}


def peers_table(rows, peers, problem):
    nosb, local, dolfinx = (solves(rows, problem, who) for who in ("nosb", "local", "dolfinx"))
    then = {(p["peer"], int(p["n"])): float(p["cpu"]) for p in peers if p["problem"] == problem}
    out = []
    for n in sorted(nosb):
        row = [f"{n}{'²' if problem == 'P2' else '³'}", number(nosb[n]["cpu"]),
               number(local[n]["cpu"]) if n in local else ""]
        if n in dolfinx:
            row += [number(dolfinx[n]["cpu"]), number(dolfinx[n]["cpu"] / nosb[n]["cpu"])]
        else:
            row += ["", ""]
        if ("FANS", n) in then and n in dolfinx:
            fans = then["FANS", n] / then["dolfinx", n] * dolfinx[n]["cpu"]
            row += [number(fans), number(fans / nosb[n]["cpu"]), number(fans / local[n]["cpu"])]
        elif problem == "P3":
            row += ["", "", ""]
        row += [nosb[n]["iterations"] // nosb[n]["loads"], number(nosb[n]["bytes_per_node"])]
        out.append(row)
    head = ["grid", "nosb, CPU s", "local, CPU s", "dolfinx, CPU s", "dolfinx / nosb"]
    if problem == "P3":
        head += ["FANS, CPU s (scaled)", "FANS / nosb", "FANS / local"]
    return table(head + ["iterations a load", "bytes a node"], out)


def worst_error(row):
    return max(abs(row[k] / v - 1.0) for k, v in EXACT.items()) * 100.0


def curves(rows, peers):
    ours = sorted((r["cpu"], worst_error(r), r["n"]) for r in solves(rows, "SC", "nosb").values())
    dolfinx = sorted((r["cpu"], worst_error(r), r["n"]) for r in solves(rows, "SC", "dolfinx").values())
    now = {r["n"]: r["cpu"] for r in solves(rows, "P3", "dolfinx").values()}
    then = {int(p["n"]): float(p["cpu"]) for p in peers if p["peer"] == "dolfinx" and p["problem"] == "P3"}
    common = [now[n] / then[n] for n in now if n in then]
    slower = sum(common) / len(common) if common else 1.0
    fans = [(float(p["cpu"]) * slower, max(float(p[k]) for k in ("error_C11", "error_C12", "error_C44")),
             int(p["n"])) for p in peers if p["problem"] == "SC"]
    return {"perihom nosb": ours, "FANS 0.6.2": fans, "dolfinx, CG + GAMG": dolfinx}


def figure(data):
    fig, ax = plt.subplots(figsize=(8, 5), dpi=100)
    style = {"perihom nosb": ("#0072b2", "o"), "FANS 0.6.2": ("#d55e00", "s"), "dolfinx, CG + GAMG": ("#009e73", "^")}
    for name, points in data.items():
        if not points:
            continue
        colour, marker = style[name]
        x, y, n = zip(*points)
        ax.loglog(x, y, marker=marker, color=colour, label=name)
        for xi, yi, ni in points:
            ax.annotate(f"{ni}³", (xi, yi), textcoords="offset points", xytext=(6, 5), color=colour, fontsize=9)
    ax.set_xlabel("CPU seconds, six loads")
    ax.set_ylabel("worst error of C11, C12, C44 [%]")
    ax.set_title("Simple-cubic spheres 0.2, contrast 10: what an error costs")
    ax.grid(True, which="both", alpha=0.25)
    ax.legend()
    fig.tight_layout()
    fig.savefig(ROOT / "docs/pictures/equal-error.png")


def interpolate(points, error):
    """CPU seconds at which a curve reaches an error, log-log between its grids."""
    from math import exp, log
    for (c0, e0, _), (c1, e1, _) in zip(points, points[1:]):
        if e0 >= error >= e1:
            t = log(e0 / error) / log(e0 / e1)
            return exp(log(c0) + t * log(c1 / c0))
    return None


def error_table(data):
    out = []
    for error in (2.5, 1.1, 0.5):
        ours = interpolate(data["perihom nosb"], error)
        row = [f"{error} %", number(ours) if ours else f"< {number(data['perihom nosb'][0][0])} (8³: {number(data['perihom nosb'][0][1], 2)} %)"]
        base = ours or data["perihom nosb"][0][0]
        for peer in ("FANS 0.6.2", "dolfinx, CG + GAMG"):
            c = interpolate(data[peer], error)
            row += [number(c), number(c / base)] if c else ["", ""]
        out.append(row)
    return table(["error", "perihom, CPU s", "FANS, CPU s", "ratio", "dolfinx, CPU s", "ratio"], out)


def sc_table(data):
    return table(["code", "grid", "CPU s", "worst error, %"],
                 [[name, f"{n}³", number(c), number(e)] for name, pts in data.items() for c, e, n in pts])


def iteration_table(rows):
    out = [["²".join([str(r["n"][0]), ""]) if r["n"][2] == 1 else f"{r['n'][0]}³", r["points"], r["horizon"] or "", r["route"],
            number(r["ns_per_node"]), number(r["apply"]), number(r["transforms"]), number(r["preconditioner"]),
            number(r["vectors"]), f"{100 * r['transform_share']:.0f} %", number(r["bytes_per_node"])]
           for r in rows if r["bench"] == "iteration"]
    out.sort(key=lambda r: (r[0], r[1], str(r[2]), r[3]))
    return table(["grid", "points", "horizon", "route", "iteration, ns/node", "operator", "of it transforms",
                  "preconditioner", "vectors", "transforms' share", "bytes/node"], out)


def crossed(rows, bench, key, name, text):
    """Tolerances across, key down; text of a row."""
    mine = [r for r in rows if r["bench"] == bench]
    tolerances = sorted({r["tolerance"] for r in mine}, reverse=True)
    cell = {(key(r), r["tolerance"]): text(r) for r in mine}
    down = list(dict.fromkeys(key(r) for r in mine))
    return table([name] + [f"{t:g}" for t in tolerances],
                 [[k] + [cell.get((k, t), "") for t in tolerances] for k in down])


def precision_blocks(rows):
    def grid(r):
        return f"{r['n']}{'³' if r['problem'] == 'SC' else '²'}"

    def contrast(r):
        return f"{r['contrast']:g}" if r["contrast"] else "void"

    def error(x):
        return "refused" if x is None else number(x, 2)
    return {
        "precision-time": crossed(rows, "precision", grid, "grid", lambda r: f"{r['cpu_ratio']:.2f}"),
        "precision-bytes": crossed(rows, "precision", grid, "grid", lambda r: f"{r['bytes_ratio']:.2f}"),
        "precision-errors": crossed(rows, "precision_errors", contrast, "contrast",
                                    lambda r: f"{error(r['error_double'])} / {error(r['error_single'])}"),
        "precision-iterations": crossed(rows, "precision_errors", contrast, "contrast",
                                        lambda r: f"{r['iterations_double']} / {r['iterations_single']}"
                                        if r["iterations_double"] >= 0 else "")}


def plain(rows, bench, columns):
    return table([c.replace("_", " ") for c in columns],
                 [[r[c] for c in columns] for r in rows if r["bench"] == bench])


def main(path):
    rows, peers = read_measured(path), read_peers()
    data = curves(rows, peers)
    figure(data)
    blocks = {"p2": peers_table(rows, peers, "P2"), "p3": peers_table(rows, peers, "P3"),
              "equal-error": error_table(data), "spheres": sc_table(data), "iteration": iteration_table(rows),
              "horizon": plain(rows, "horizon", ["n", "ratio_12_over_2"]),
              "threads": plain(rows, "threads", ["problem", "n", "wall_1", "wall_2", "speedup", "cpu_1", "cpu_2", "same_bits"])}
    blocks.update(precision_blocks(rows))
    page = ROOT / "docs/performance.md"
    text = page.read_text()
    for name, lines in blocks.items():
        pattern = rf"(<!-- table: {name} -->\n).*?(<!-- end -->)"
        text = re.sub(pattern, lambda m: m.group(1) + "\n".join(lines) + "\n" + m.group(2), text, flags=re.S)
    page.write_text(text)


if __name__ == "__main__":
    main(sys.argv[1])
