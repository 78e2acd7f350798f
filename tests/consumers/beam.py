# SPDX-License-Identifier: GPL-3.0-or-later
"""A plane block in sfepy whose integration points have a stiffness and an internal stress of
their own: what the tests and docs/make_beam.py share."""
import numpy as np
from sfepy.base.base import output
from sfepy.discrete import (Equation, Equations, FieldVariable, Function, Integral, Material, Problem)
from sfepy.discrete.conditions import Conditions, EssentialBC
from sfepy.discrete.fem import FEDomain, Field
from sfepy.mesh.mesh_generators import gen_block_mesh
from sfepy.solvers.ls import ScipyDirect
from sfepy.solvers.nls import Newton
from sfepy.terms import Term

output.set_output(quiet=True)


class Block:
    """length x height in nx x ny quadrilaterals of an order; x from 0, y about 0.

    points: [n][2] where the integration points are; stiffness [n][3][3] and stress [n][3] of
    them (order 11 22 12, engineering shear) are set before `solve`. conditions(block, move):
    what is held and what is moved; default: clamped at the left, the right end moved across.
    """

    def __init__(self, length, height, nx, ny, order, conditions=None):
        self.conditions = conditions or Block.clamped
        mesh = gen_block_mesh([length, height], [nx + 1, ny + 1], [length / 2, 0], verbose=False)
        domain = FEDomain("domain", mesh)
        tiny = 1e-8 * length
        self.omega = domain.create_region("Omega", "all")
        self.all = self.omega
        self.left = domain.create_region("Left", "vertices in x < %.17g" % tiny, "facet")
        self.right = domain.create_region("Right", "vertices in x > %.17g" % (length - tiny), "facet")
        field = Field.from_args("field", np.float64, "vector", self.omega, approx_order=order)
        self.u = FieldVariable("u", "unknown", field)
        self.v = FieldVariable("v", "test", field, primary_var_name="u")
        self.points = self.stiffness = self.stress = None
        integral = Integral("i", order=2 * order)
        self.m = Material("m", function=Function("values", self._values))
        terms = (Term.new("dw_lin_elastic(m.D, v, u)", integral, self.omega, m=self.m, v=self.v, u=self.u)
                 + Term.new("dw_lin_prestress(m.S, v)", integral, self.omega, m=self.m, v=self.v))
        self.strain_term = Term.new("ev_cauchy_strain(u)", integral, self.omega, u=self.u)
        self.strain_term.setup()
        self.problem = Problem("block", equations=Equations([Equation("balance", terms)]))
        self.problem.set_solver(Newton({"i_max": 1, "eps_a": 1e-300, "eps_r": 1.0, "is_linear": True},
                                       lin_solver=ScipyDirect({})))
        self.stiffness = np.eye(3)
        self.solve(0.0)  # the points are known after it

    def _values(self, ts, coors, mode=None, **ignored):
        if mode != "qp":
            return None
        n = len(coors)
        self.points = coors
        S = np.zeros((n, 3)) if self.stress is None else self.stress
        return {"D": np.array(np.broadcast_to(self.stiffness, (n, 3, 3)), order="C"),
                "S": np.array(S.reshape(n, 3, 1), order="C")}

    def clamped(self, move):
        return [EssentialBC("clamp", self.left, {"u.all": 0.0}), EssentialBC("tip", self.right, {"u.1": move})]

    def solve(self, move):
        """Strain [n][3] of the equilibrium."""
        self.problem.set_bcs(ebcs=Conditions(self.conditions(self, move)))
        self.problem.solve(save_results=False)
        return self.strain_term.evaluate(mode="qp").reshape(-1, 3)

    def work(self, stress, strain):
        """Integral of stress : strain."""
        weights = self.strain_term.get_mapping(self.u)[0].det.reshape(-1, 1)
        return float(np.sum(weights * stress * strain))
