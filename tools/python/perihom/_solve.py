# SPDX-License-Identifier: GPL-3.0-or-later
"""How a solve of the library is called: its problem, progress, interruption."""
from __future__ import annotations

from ._base import _check, _enum, _owned
from ._perihom import ffi, lib

_POINTS = {"auto": 0, "nodes": 1, "stress": 2}
_INTERFACE = {"composite": 0, "node_centre": 1}


def _keep_error(kind, error, trace):
    """What `progress`, or a signal on the way to it, raised: comes back to the caller of the solve."""
    ffi.from_handle(trace.tb_frame.f_locals["user"])["error"] = error.with_traceback(trace)


@ffi.def_extern(error=False, onerror=_keep_error)
def perihom_progress(user, now):
    # Also where no one listens: the interpreter handles signals, Ctrl-C, while this runs.
    call = ffi.from_handle(user)["call"]
    return call is None or call(now.load, now.loads, now.iteration, now.residual) is not False


def _problem(micro, case, model=None, points=None, horizon=None, constraint=None, solver=None, interface=None,
             tolerance=None, precision=None, loads=None, fields=None):
    """A ph_problem and what it borrows."""
    problem = ffi.new("ph_problem *")
    keep = []

    def word(value):
        keep.append(ffi.new("char[]", value.encode()))
        return keep[-1]

    problem.micro = micro._c
    if case is not None:
        plan, err = ffi.new("ph_crack_plan **"), ffi.new("ph_error *")
        _check(lib.ph_rve_cracks(case._c, plan, err), err)
        keep.append(_owned(plan[0], "ph_crack_plan", lib.ph_crack_plan_free))
        problem[0] = lib.ph_rve_problem(case._c, micro._c, keep[-1])
    if model is not None:
        problem.model.kind = word(model)
    if points is not None:
        problem.model.points = _enum("points", points, _POINTS)
    if horizon is not None:
        problem.model.horizon, problem.model.horizon_is_length = horizon, False
    if constraint is not None:
        problem.constraint.kind = word(constraint)
    if solver is not None:
        problem.solver.kind = word(solver)
    if precision is not None:
        problem.solver.precision = word(precision)
    if interface is not None:
        problem.interface = _enum("interface", interface, _INTERFACE)
    if tolerance is not None:
        problem.solver.tolerance = tolerance
    if fields is not None:
        problem.keep_fields = fields
    for load in loads if loads is not None else ():
        if not 0 <= load < 6:
            raise ValueError("a load is 0 to 5, got %r" % load)
        problem.loads |= 1 << load
    return problem, keep


def _call(solve, threads: int, progress, free) -> None:
    """Runs a solve: progress, cancelling and Ctrl-C, the interpreter released, errors raised."""
    if threads < 0:
        raise ValueError("threads must be >= 0 (0: all processors), got %d" % threads)
    ctx = ffi.new("ph_ctx *")
    ctx.threads = threads
    state = {"call": progress, "error": None}
    handle = ffi.new_handle(state)
    ctx.progress, ctx.user = lib.perihom_progress, handle
    err = ffi.new("ph_error *")
    status = solve(ctx, err)
    if status or state["error"] is not None:
        free()
    if state["error"] is not None:
        raise state["error"]
    _check(status, err)
