#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The benchmark problems with FEniCSx (Debian: python3-dolfinx-real), periodic, Q1 on voxels.

usage: peer_dolfinx.py P2|P3|SC N      prints one JSON line, times in CPU seconds

2D: MUMPS Cholesky, one factorisation for all loads. 3D: CG to 1e-6 with algebraic
multigrid (GAMG) that knows the rigid motions. Opposite faces are joined by K -> P^T K P.
"""
import json
import os
import sys
import time

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import ufl
from dolfinx import fem, mesh
from dolfinx.fem.petsc import assemble_matrix
from mpi4py import MPI
from petsc4py import PETSc

PROBLEMS = {  # dimension, (E, nu) of matrix and inclusion, fraction, radius from it
    "P2": (2, (68.3, 0.30), (379.3, 0.10), 0.47),
    "P3": (3, (3.5, 0.35), (70.0, 0.20), 0.25),
    "SC": (3, (1.0, 0.30), (10.0, 0.30), 0.20),
}


def lame(E, nu):
    return E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))


def voxel_form(dim, n, matrix, inclusion, fraction):
    comm, kind = MPI.COMM_SELF, mesh.CellType
    if dim == 2:
        domain = mesh.create_rectangle(comm, [np.zeros(2), np.ones(2)], [n] * 2, kind.quadrilateral)
        radius2 = fraction / np.pi
    else:
        domain = mesh.create_box(comm, [np.zeros(3), np.ones(3)], [n] * 3, kind.hexahedron)
        radius2 = (3 * fraction / (4 * np.pi)) ** (2 / 3)
    V = fem.VectorFunctionSpace(domain, ("CG", 1))
    Q = fem.FunctionSpace(domain, ("DG", 0))
    cells = domain.topology.index_map(dim).size_local
    centre = mesh.compute_midpoints(domain, dim, np.arange(cells, dtype=np.int32))[:, :dim]
    inside = ((centre - 0.5) ** 2).sum(axis=1) <= radius2
    coefficients = []
    for c_inclusion, c_matrix in zip(lame(*inclusion), lame(*matrix)):
        c = fem.Function(Q)
        c.x.array[Q.dofmap.list.array[:cells]] = np.where(inside, c_inclusion, c_matrix)
        coefficients.append(c)
    lam, mu = coefficients
    u, v = ufl.TrialFunction(V), ufl.TestFunction(V)
    strain = lambda w: ufl.sym(ufl.grad(w))
    energy = lam * ufl.div(u) * ufl.div(v) + 2 * mu * ufl.inner(strain(u), strain(v))
    options = {"cffi_extra_compile_args": ["-O3", "-march=native"]}
    return V, fem.form(energy * ufl.dx(metadata={"quadrature_degree": 2}), jit_params=options)


def periodic_map(x, n, dim):
    at = np.rint(x * n).astype(np.int64) % n
    node = np.ravel_multi_index(tuple(at.T), (n,) * dim)
    columns = (node[:, None] * dim + np.arange(dim)).ravel().astype(np.int32)
    rows = np.arange(columns.size + 1, dtype=np.int32)
    P = PETSc.Mat().createAIJ(size=(columns.size, n**dim * dim),
                              csr=(rows, columns, np.ones(columns.size)))
    P.setBlockSizes(dim, dim)
    place = np.zeros((n**dim, dim))
    place[node] = at / n
    return P, place


def rigid_motions(A, place):
    dim = place.shape[1]
    motions = [np.eye(dim)[np.full(len(place), d)] for d in range(dim)]
    for i in range(dim):
        for j in range(i):
            turn = np.zeros_like(place)
            turn[:, i], turn[:, j] = -(place[:, j] - 0.5), place[:, i] - 0.5
            motions.append(turn)
    basis, _ = np.linalg.qr(np.stack([m.ravel() for m in motions], axis=1))
    vectors = []
    for column in basis.T:
        v = A.createVecRight()
        v.array[:] = column
        vectors.append(v)
    return PETSc.NullSpace().create(vectors=vectors)


def solver(A, place, dim):
    ksp = PETSc.KSP().create()
    ksp.setOperators(A)
    if dim == 2:
        ksp.setType("preonly")
        ksp.pc.setType("cholesky")
        ksp.pc.setFactorSolverType("mumps")
    else:
        A.setNearNullSpace(rigid_motions(A, place))
        ksp.setType("cg")
        ksp.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
        ksp.setTolerances(rtol=1e-6, atol=0.0)
        ksp.pc.setType("gamg")
        PETSc.Options()["mg_levels_ksp_type"] = "chebyshev"
        PETSc.Options()["mg_levels_pc_type"] = "jacobi"
    ksp.setFromOptions()
    ksp.setUp()
    return ksp


def main(name, n):
    dim, matrix, inclusion, fraction = PROBLEMS[name]
    V, form = voxel_form(dim, n, matrix, inclusion, fraction)
    start = time.process_time()
    K = assemble_matrix(form)
    K.assemble()
    x = V.tabulate_dof_coordinates()[:, :dim]
    P, place = periodic_map(x, n, dim)
    A = K.PtAP(P)
    A.setBlockSize(dim)
    A.zeroRowsColumns(np.arange(dim, dtype=np.int32), diag=A.getDiagonal().array.mean())
    A.setOption(PETSc.Mat.Option.SPD, True)
    ksp = solver(A, place, dim)
    assembled = time.process_time() - start
    total, work, iterations = [], [], 0
    for i, j in [(d, d) for d in range(dim)] + ([(0, 1)] if dim == 2 else [(1, 2), (0, 2), (0, 1)]):
        affine = np.zeros((len(x), dim))
        affine[:, i] += 0.5 * x[:, j]
        affine[:, j] += 0.5 * x[:, i]
        u, load, w = K.createVecRight(), A.createVecRight(), A.createVecRight()
        u.array[:] = affine.ravel()
        P.multTranspose(K * (-u), load)
        load.array[:dim] = 0.0
        ksp.solve(load, w)
        iterations += ksp.getIterationNumber()
        P.multAdd(w, u, u)
        total.append(u)
        work.append(K * u)
    C = [[a.dot(b) for b in work] for a in total]
    print(json.dumps({"bench": "peer", "peer": "dolfinx", "problem": name, "n": n,
                      "cpu": time.process_time() - start, "cpu_setup": assembled,
                      "iterations": iterations, "loads": len(total), "C11": C[0][0],
                      "C12": C[0][1], "C_shear": C[-1][-1]}))


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
