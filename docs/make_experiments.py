#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Synthetic measurements in data/experiments: a resin with a known Prony series, with noise.

The files say that they are synthetic and of what. Usage: docs/make_experiments.py [FOLDER]
"""
import math
import random
import sys

# GPa and s at 120 degrees Celsius
INFINITY = 0.02
TERMS = [(0.35, 1e-5), (0.40, 1e-4), (0.52, 1e-3), (0.55, 1e-2), (0.50, 1e-1), (0.35, 1.0),
         (0.18, 10.0), (0.08, 100.0), (0.03, 1000.0)]
C1, C2, REFERENCE = 15.0, 55.0, 120.0  # WLF
SEED = 1

WHAT = """# SYNTHETIC, made by docs/make_experiments.py: not a measurement of any real material.
# M(t) = {0} + sum M_k exp(-t/tau_k) GPa at {3} C with (M_k, tau_k) =
#   {4}
# {5}
# Normal relative noise with standard deviation {6}, seed {7}.
"""


def factor(temperature):
    d = temperature - REFERENCE
    return 10 ** (-C1 * d / (C2 + d))


def relaxation(t):
    return INFINITY + sum(m * math.exp(-t / tau) for m, tau in TERMS)


def dynamic(w):
    storage, loss = INFINITY, 0.0
    for m, tau in TERMS:
        z = w * tau
        storage += m * z * z / (1 + z * z)
        loss += m * z / (1 + z * z)
    return storage, loss


def creep(times):
    """J(t) from M by the Volterra equation, integrated exactly for each exponential: solved
    here through the partial fractions of 1/M(s), with zeros by bisection."""
    inv = sorted(1 / tau for _, tau in TERMS)

    def modulus(p):  # Carson modulus at s = -p
        return INFINITY + sum(m * p * tau / (p * tau - 1) for m, tau in TERMS)

    zeros = []
    for lo, hi in zip([0.0] + inv[:-1], inv):
        a, b = lo, hi
        for _ in range(300):
            c = 0.5 * (a + b)
            # between poles M falls from +inf to -inf; before the first from INFINITY
            if modulus(c) > 0:
                a = c
            else:
                b = c
        zeros.append(0.5 * (a + b))
    out = []
    rest = 1 / INFINITY
    weights = []
    for p in zeros:  # J_k = 1 / (p M'(p)) up to sign
        slope = sum(m * (-tau) / (p * tau - 1) ** 2 for m, tau in TERMS)
        weights.append(-1 / (p * slope))
    for t in times:
        out.append(rest - sum(w * math.exp(-p * t) for w, p in zip(weights, zeros)))
    return out


def head(law, noise):
    terms = ", ".join("(%g, %g)" % term for term in TERMS)
    return WHAT.format(INFINITY, C1, C2, REFERENCE, terms, law, noise, SEED)


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else "data/experiments"
    noise = 0.01
    law = "Times shift with temperature by WLF, C1 = %g, C2 = %g." % (C1, C2)
    with open(folder + "/resin-dma.csv", "w", encoding="ascii") as f:
        rng = random.Random(SEED)
        f.write(head(law, noise))
        f.write("temperature (C),frequency (Hz),storage (GPa),loss (GPa)\n")
        for temperature in (105, 110, 115, 120, 125, 130, 140, 150):
            for k in range(13):
                frequency = 0.1 * 10 ** (k / 4)
                storage, loss = dynamic(2 * math.pi * frequency * factor(temperature))
                f.write("%g,%.4g,%.5g,%.5g\n" % (temperature, frequency,
                                                 storage * rng.gauss(1, noise),
                                                 loss * rng.gauss(1, noise)))
    with open(folder + "/resin-relaxation.csv", "w", encoding="ascii") as f:
        rng = random.Random(SEED)
        f.write(head("One temperature, %g C." % REFERENCE, noise))
        f.write("time (s),modulus (GPa)\n")
        for k in range(81):
            t = 1e-4 * 10 ** (k / 10)
            f.write("%.5g,%.5g\n" % (t, relaxation(t) * rng.gauss(1, noise)))
    with open(folder + "/resin-creep.csv", "w", encoding="ascii") as f:
        rng = random.Random(SEED)
        f.write(head("One temperature, %g C; J(s) M(s) = 1." % REFERENCE, noise))
        f.write("time (s),compliance (1/GPa)\n")
        times = [1e-6 * 10 ** (k / 10) for k in range(121)]
        for t, value in zip(times, creep(times)):
            f.write("%.5g,%.5g\n" % (t, value * rng.gauss(1, noise)))


if __name__ == "__main__":
    main()
