# SPDX-License-Identifier: GPL-3.0-or-later
"""The block of beam.py without sfepy: bilinear quadrilaterals, 2 x 2 integration points, NumPy."""
import numpy as np


class Block:
    """length x height in nx x ny quadrilaterals; x from 0, y about 0; see beam.Block."""

    def __init__(self, length, height, nx, ny, order=1, conditions=None):
        self.conditions = conditions or Block.clamped
        x, y = np.meshgrid(np.linspace(0, length, nx + 1), np.linspace(-height / 2, height / 2, ny + 1), indexing="ij")
        self.nodes = np.column_stack([x.ravel(), y.ravel()])
        number = np.arange(len(self.nodes)).reshape(nx + 1, ny + 1)
        self.cells = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], -1).reshape(-1, 4)
        self.left, self.right, self.all = x.ravel() == 0, x.ravel() == length, np.ones(len(self.nodes), bool)
        h, g = np.array([length / nx, height / ny]), 1 / np.sqrt(3)
        corner = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        gauss = g * corner
        self.B = np.zeros((4, 3, 8))  # [point of a cell][11 22 12][4 nodes x 2]
        for p, at in enumerate(gauss):
            d = corner * (1 + corner[:, ::-1] * at[::-1]) / 4 * 2 / h
            self.B[p, 0, 0::2] = self.B[p, 2, 1::2] = d[:, 0]
            self.B[p, 1, 1::2] = self.B[p, 2, 0::2] = d[:, 1]
        self.weight = h.prod() / 4
        self.points = (self.nodes[self.cells].mean(axis=1)[:, None] + gauss * h / 2).reshape(-1, 2)
        self.at = (2 * self.cells[:, :, None] + np.arange(2)).reshape(-1, 8)
        self.stiffness, self.stress = np.eye(3), None

    @staticmethod
    def clamped(block, move):
        return [(block.left, 0, 0.0), (block.left, 1, 0.0), (block.right, 1, move)]

    def solve(self, move):
        """Strain [n][3] of the equilibrium."""
        n, points = 2 * len(self.nodes), len(self.points)
        D = np.broadcast_to(self.stiffness, (points, 3, 3)).reshape(-1, 4, 3, 3)
        S = (np.zeros((points, 3)) if self.stress is None else self.stress).reshape(-1, 4, 3)
        K, f, u = np.zeros((n, n)), np.zeros(n), np.zeros(n)
        np.add.at(K, (self.at[:, :, None], self.at[:, None, :]),
                  self.weight * np.einsum("pai,epab,pbj->eij", self.B, D, self.B))
        np.add.at(f, self.at, -self.weight * np.einsum("pai,epa->ei", self.B, S))
        free = np.ones(n, bool)
        for where, axis, value in self.conditions(self, move):
            held = 2 * np.flatnonzero(where) + axis
            u[held], free[held] = value, False
        f -= K @ u
        u[free] = np.linalg.solve(K[np.ix_(free, free)], f[free])
        return np.einsum("pai,ei->epa", self.B, u[self.at]).reshape(-1, 3)

    def work(self, stress, strain):
        """Integral of stress : strain."""
        return float(self.weight * np.sum(stress * strain))
