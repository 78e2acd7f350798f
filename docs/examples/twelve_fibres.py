# SPDX-License-Identifier: GPL-3.0-or-later
# Twelve disks that do not touch, on 128 x 128 cells: the voxels of docs/tutorial.md.
import numpy as np

rng = np.random.default_rng(1)
n, radius, gap = 128, 0.1, 0.01
x, y = np.meshgrid(*2 * [(np.arange(n) + 0.5) / n], indexing="ij")
phase = np.zeros((n, n), np.uint8)
placed = []


def apart(a, b):
    """The shortest vector between two points of a periodic box."""
    return a - b - np.round(a - b)


while len(placed) < 12:
    c = rng.random(2)
    if all(np.hypot(*apart(c, p)) > 2 * radius + gap for p in placed):
        placed.append(c)
        phase[np.hypot(apart(x, c[0]), apart(y, c[1])) < radius] = 1
np.save("twelve.npy", phase)
