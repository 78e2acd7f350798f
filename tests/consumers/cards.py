#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Cards read back by the rules of their codes, from the words alone, and the tensor rebuilt.

The rules, written down here once more: order of components, which Poisson's ratio is meant
(nu_ij: strain along j under stress along i), widths of columns, how a Prony series is given.
Prints TAP.
"""
import json
import re
import sys

import numpy as np

import perihom

rng = np.random.default_rng(1)
OURS = ["11", "22", "33", "23", "13", "12"]
ABAQUS, ANSYS = ["11", "22", "33", "12", "13", "23"], ["11", "22", "33", "12", "23", "13"]
number = failed = 0


def check(what, got, want, digits):
    global number, failed
    number += 1
    off = np.abs(np.asarray(got) - want).max() / np.abs(want).max()
    good = off < digits
    failed += not good
    print("%s %d - %s, off by %.1e" % ("ok" if good else "not ok", number, what, off), flush=True)


def stiffness():
    A = rng.normal(size=(6, 6))
    return A @ A.T + 6 * np.eye(6)


def orthotropic():
    C = np.diag(rng.uniform(1, 3, 6))
    A = rng.normal(size=(3, 3))
    C[:3, :3] = A @ A.T + 3 * np.eye(3)
    return C


def from_order(D, order):
    at = [order.index(name) for name in OURS]
    return np.asarray(D)[np.ix_(at, at)]


def engineering(E1, E2, E3, nu12, nu13, nu23, G12, G13, G23):
    S = np.zeros((6, 6))
    S[:3, :3] = [[1 / E1, -nu12 / E1, -nu13 / E1], [-nu12 / E1, 1 / E2, -nu23 / E2], [-nu13 / E1, -nu23 / E2, 1 / E3]]
    S[3, 3], S[4, 4], S[5, 5] = 1 / G23, 1 / G13, 1 / G12
    return np.linalg.inv(S)


def isotropic(E, nu):
    return engineering(E, E, E, nu, nu, nu, *[E / 2 / (1 + nu)] * 3)


def lines(text, comment):
    return [line for line in text.splitlines() if line and not line.startswith(comment)]


def keyword(text, name):
    """Numbers of the lines after a keyword of Abaqus up to the next one."""
    block = re.search(r"^\*%s[^\n]*\n((?:[^*].*\n?)*)" % name, text, re.M)[1]
    return [float(x) for x in re.findall(r"[^,\s]+", block)]


def columns(line, width):
    return [float(line[i:i + width]) for i in range(0, len(line.rstrip("\n")), width)]


def upper_by_columns(values, order):
    D, n = np.zeros((6, 6)), 0
    for j in range(6):
        for i in range(j + 1):
            D[i, j] = D[j, i] = values[n]
            n += 1
    return from_order(D, order)


# ---- each code ----------------------------------------------------------------------------


def abaqus(text):
    if "TYPE=ISO" in text:
        return isotropic(*keyword(text, "ELASTIC, TYPE=ISO"))
    if "ENGINEERING" in text:
        return engineering(*keyword(text, "ELASTIC, TYPE=ENGINEERING CONSTANTS"))
    return upper_by_columns(keyword(text, "ELASTIC, TYPE=ANISO"), ABAQUS)


def ansys(text):
    p = {m[0]: float(m[1]) for m in re.findall(r"^MP,(\w+),\d+,(\S+)$", text, re.M)}
    if "EY" in p:
        return engineering(p["EX"], p["EY"], p["EZ"], p["PRXY"], p["PRXZ"], p["PRYZ"], p["GXY"], p["GXZ"], p["GYZ"])
    if "EX" in p:
        return isotropic(p["EX"], p["PRXY"])
    table = {}
    for first, values in re.findall(r"^TBDATA,(\d+),(.*)$", text, re.M):
        for k, v in enumerate(values.split(",")):
            table[int(first) + k] = float(v)
    D, n = np.zeros((6, 6)), 0
    for j in range(6):  # columns of the lower triangle
        for i in range(j, 6):
            n += 1
            D[i, j] = D[j, i] = table[n]
    return from_order(D, ANSYS)


def aster(text):
    p = {m[0]: float(m[1]) for m in re.findall(r"\b([A-Z][A-Z_]*)=([-+.\deE]+)", text)}
    if "E_L" not in p:
        return isotropic(p["E"], p["NU"])
    return engineering(p["E_L"], p["E_T"], p["E_N"], p["NU_LT"], p["NU_LN"], p["NU_TN"], p["G_LT"], p["G_LN"], p["G_TN"])


def ls_dyna(text):
    rows = lines(text, "$")
    assert all(len(row) <= 80 for row in rows)
    kind, data = rows[0], [columns(row, 10) for row in rows[1:]]
    if kind == "*MAT_ELASTIC":
        return isotropic(data[0][2], data[0][3])
    if kind == "*MAT_ORTHOTROPIC_ELASTIC":
        _, _, a, b, c, ba, ca, cb = data[0]
        gab, gbc, gca, aopt = data[1]
        assert aopt == 2 and data[2][3:] == [1, 0, 0] and data[3][3:] == [0, 1, 0]
        return engineering(a, b, c, ba * a / b, ca * a / c, cb * b / c, gab, gca, gbc)
    assert kind == "*MAT_ANISOTROPIC_ELASTIC" and data[2][7] == 2
    return upper_by_columns(data[0][2:] + data[1] + data[2][:7], ANSYS)


def radioss(text):
    rows = lines(text, "#")
    assert rows[0].startswith("/MAT/ELAST/") and len(rows[3]) == 40
    return isotropic(*columns(rows[3], 20))


def matrix(text):
    body = text[text.index("(["):]
    return np.array([float(x) for x in re.findall(r"[-+]?\d[\d.]*(?:e[-+]?\d+)?", body)[:36]]).reshape(6, 6)


def sfepy(text):
    return from_order(matrix(text), ABAQUS)


CODES = {"abaqus": abaqus, "calculix": abaqus, "ansys": ansys, "aster": aster, "ls_dyna": ls_dyna, "radioss": radioss,
         "sfepy": sfepy, "fenics": matrix, "json": lambda text: np.array(json.loads(text)["stiffness"])}
ALIASES = {"aster": "code_aster", "radioss": "openradioss"}


def tensors():
    formats = {m["name"] for m in perihom.catalogue("formats")}
    cases = [("isotropic", isotropic(3.7, 0.31)), ("orthotropic", orthotropic()), ("anisotropic", stiffness())]
    for code, read in CODES.items():
        name = code if code in formats else ALIASES.get(code, code)
        for kind, C in cases:
            try:
                text = perihom.Effective(C).card(name)
            except perihom.Error as error:  # what a law does not hold
                assert "nearest" in str(error), error
                print("# %s takes no %s tensor" % (name, kind))
                continue
            # digits: 11 in free formats, 17 in Python and JSON, what fits into ten columns (7, less with an exponent)
            check("%s, %s" % (name, kind), read(text), C, 2e-6 if code == "ls_dyna" else 1e-9)


# ---- Prony --------------------------------------------------------------------------------


def curve(K, G, t):
    """C(t) of bulk and shear moduli: [(modulus, time)], the first of infinite time."""
    k, g = (sum(m * np.exp(-t / tau) for m, tau in M) for M in (K, G))
    E, nu = 9 * k * g / (3 * k + g), (3 * k - 2 * g) / (2 * (3 * k + g))
    return isotropic(E, nu)


def split(E, nu):
    return E / 3 / (1 - 2 * nu), E / 2 / (1 + nu)


def relative(K0, G0, rows):
    """Of relative moduli k_i, g_i and times."""
    inf = float("inf")
    K = [(K0 * (1 - sum(k for k, g, t in rows)), inf)] + [(K0 * k, t) for k, g, t in rows]
    G = [(G0 * (1 - sum(g for k, g, t in rows)), inf)] + [(G0 * g, t) for k, g, t in rows]
    return K, G


def prony_abaqus(text):
    v = keyword(text, "VISCOELASTIC")
    rows = [(v[i + 1], v[i], v[i + 2]) for i in range(0, len(v), 3)]  # the card: g, k, tau
    return relative(*split(*keyword(text, "ELASTIC, MODULI=INSTANTANEOUS")), rows)


def prony_ansys(text):
    p = {m[0]: float(m[1]) for m in re.findall(r"^MP,(\w+),\d+,(\S+)$", text, re.M)}
    series = {}
    for kind, body in re.findall(r"^TB,PRONY,\d+,,\d+,(\w+)\n((?:TBDATA.*\n?)+)", text, re.M):
        v = [float(x) for row in body.split() for x in row.split(",")[2:]]
        series[kind] = list(zip(v[::2], v[1::2]))
    rows = [(k, g, t) for (g, t), (k, _) in zip(series["SHEAR"], series["BULK"])]
    return relative(*split(p["EX"], p["PRXY"]), rows)


def prony_dyna(text):
    rows = lines(text, "$")
    assert rows[0] == "*MAT_GENERAL_VISCOELASTIC"
    K, G = [], []
    for g, beta, k, beta_k in (columns(row, 10) for row in rows[3:]):
        G.append((g, 1 / beta if beta else float("inf")))
        K.append((k, 1 / beta_k if beta_k else float("inf")))
    return K, G


def series():
    C = [isotropic(9 * k * g / (3 * k + g), (3 * k - 2 * g) / (2 * (3 * k + g)))
         for k, g in ((2.0, 0.3), (1.0, 0.7), (0.4, 0.2), (0.3, 0.9))]
    s = perihom.Series(C[0], [(0.02, C[1]), (1.5, C[2]), (400.0, C[3])])
    many = perihom.Series(C[0], [(10.0 ** k, C[1] / 18) for k in range(18)])
    try:
        perihom.Effective(many).card("ls_dyna")
        check("ls_dyna, 18 terms are refused", 1, 0.5, 0)
    except perihom.Error as error:
        assert "17" in str(error) and "compress" in str(error), error
    few, _ = many.compress(terms=5)
    perihom.Effective(few).card("ls_dyna")
    for code, read in (("abaqus", prony_abaqus), ("calculix", prony_abaqus), ("ansys", prony_ansys), ("ls_dyna", prony_dyna)):
        try:
            text = perihom.Effective(s).card(code)
        except perihom.Error as error:
            print("# %s: %s" % (code, error))
            continue
        K, G = read(text)
        for t in (0.0, 0.01, 1.0, 100.0, 1e9):
            check("%s, relaxed to t = %g" % (code, t), curve(K, G, t), s.at(t), 2e-6 if code == "ls_dyna" else 1e-9)


tensors()
series()
print("1..%d" % number)
sys.exit(failed > 0)
