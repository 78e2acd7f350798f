# SPDX-License-Identifier: GPL-3.0-or-later
"""FE2: an RVE at every integration point of a macroscale code, solved when it is asked."""
from __future__ import annotations

from typing import Any, Callable, List, Mapping, Optional, Sequence, Tuple

import numpy as np

from ._base import _check, _owned
from ._perihom import ffi, lib
from ._solve import _call, _problem

_KINDS = ("elastic", "viscoelastic", "failure")
_CRITERIA = ("critical_stretch", "bond_energy", "unbreakable")


def _rule(rule, strength: Mapping[str, Any], name: str) -> None:
    known = {"critical_stretch", "critical_bond_energy", "fracture_energy", "criterion", "weibull", "unbreakable"}
    unknown = set(strength) - known
    if unknown:
        raise ValueError("strength of %s: %s is none of %s" % (name, ", ".join(sorted(unknown)), ", ".join(sorted(known))))
    nan = float("nan")
    rule.given, rule.weibull = True, strength.get("weibull", 0.0)
    rule.value = strength.get("critical_stretch", strength.get("critical_bond_energy", nan))
    rule.fracture_energy = strength.get("fracture_energy", nan)
    criterion = strength.get("criterion", "bond_energy" if "critical_bond_energy" in strength else "critical_stretch")
    if criterion not in _CRITERIA:
        raise ValueError("criterion must be one of %s, got %r" % (", ".join(_CRITERIA), criterion))
    rule.criterion = 2 if strength.get("unbreakable") else _CRITERIA.index(criterion)


class FE2:
    """An RVE that the integration points of a macroscale code share.

    FE2(micro): elastic, C* once and no solve after; with phases that relax, steps of time; with
    strengths, bonds that break. settings: model, points, horizon, constraint, solver, interface,
    tolerance, precision as of homogenise; case: where settings and strengths come from that are not given.

    strengths: {material: {"critical_stretch": s}}, or "fracture_energy" (with "criterion"),
    "critical_bond_energy", "weibull", "unbreakable": as `failure` of a case file; phases that are
    not named never break. interphase: the same for bonds between two materials.
    cache: bytes for histories on which no point stands, default 128 MiB.

        rve = perihom.FE2(micro)
        at = rve.points(72)
        stress, tangent = at.update(dstrain, dt)   # as often as the macroscale iteration likes
        at.accept()

    Threads may work with points of one FE2 at once, each with its own.
    """

    def __init__(self, micro, case=None, strengths: Optional[Mapping[str, Mapping[str, Any]]] = None,
                 interphase: Optional[Mapping[str, Any]] = None, seed: int = 0, cache: int = 0, threads: int = 0,
                 progress: Optional[Callable[[int, int, int, float], Any]] = None, **settings):
        names = ("model", "points", "horizon", "constraint", "solver", "interface", "tolerance", "precision")
        unknown = set(settings) - set(names)
        if unknown:
            raise TypeError("FE2 has no setting %s" % ", ".join(sorted(unknown)))
        problem, keep = _problem(micro, case, **settings)
        if case is not None and case._c.failure.material != ffi.NULL:
            problem.failure = ffi.addressof(case._c, "failure")
        if strengths is not None:
            keep += self._strengths(micro, problem, strengths, interphase, seed)
        params = ffi.new("ph_fe2_params *", {"cache_bytes": cache})
        out = ffi.new("ph_fe2 **")
        _call(lambda ctx, err: lib.ph_fe2_new(problem, params, ctx, out, err), threads, progress,
              lambda: lib.ph_fe2_free(out))
        self._c = _owned(out[0], "ph_fe2", lib.ph_fe2_free)
        self._keep = (problem, keep, micro, case)  # borrowed by the library
        self.kind = _KINDS[lib.ph_fe2_kind_of(self._c)]
        self.components = lib.ph_fe2_components(self._c)

    @staticmethod
    def _strengths(micro, problem, strengths, interphase, seed):
        material = [ffi.string(micro._c.materials[i].name).decode() for i in range(micro._c.nmaterials)]
        unknown = set(strengths) - set(material)
        if unknown:
            raise ValueError("no material %s, there are %s" % (", ".join(sorted(unknown)), ", ".join(material)))
        rules = ffi.new("ph_failure_rule[]", len(material))
        for i, name in enumerate(material):
            if name in strengths:
                _rule(rules[i], strengths[name], name)
        failure = ffi.new("ph_failure *", {"material": rules, "seed": seed})
        if interphase is not None:
            _rule(failure.interphase, interphase, "the interphase")
        problem.failure = failure
        return [rules, failure]

    def points(self, count: int) -> "Points":
        """So many virgin points."""
        return Points(self, count)

    @property
    def counts(self) -> dict:
        """What all points have cost: updates, hits (histories that were known), solves, iterations,
        tangents, events, states, bytes."""
        c = ffi.new("ph_fe2_counts *")
        lib.ph_fe2_counts_get(self._c, c)
        return {name: int(getattr(c, name)) for name in
                ("updates", "hits", "solves", "iterations", "tangents", "events", "states", "bytes")}

    def __repr__(self):
        return "FE2(%s, %d components)" % (self.kind, self.components)


class Points:
    """Integration points with an RVE each: states that are accepted, increments that are tried."""

    def __init__(self, rve: FE2, count: int):
        if count < 0:
            raise ValueError("points must be >= 0, got %d" % count)
        self.rve = rve
        self._c = []
        self._array = ffi.new("ph_fe2_point *[]", max(1, count))
        for i in range(count):
            out, err = ffi.new("ph_fe2_point **"), ffi.new("ph_error *")
            _check(lib.ph_fe2_point_new(rve._c, out, err), err)
            self._c.append(_owned(out[0], "ph_fe2_point", lib.ph_fe2_point_free))
            self._array[i] = out[0]

    def __len__(self):
        return len(self._c)

    def update(self, dstrain: np.ndarray, dt: float = 0.0, threads: int = 0,
               progress: Optional[Callable[[int, int, int, float], Any]] = None) -> Tuple[np.ndarray, np.ndarray]:
        """Try an increment from the accepted states: stress [points][n], tangent [points][n][n].

        dstrain: [points][n], Voigt, engineering shear, linear over dt >= 0. Equal histories are
        solved once, the others in `threads` threads. Raises Error, then nothing is tried.
        """
        n = self.rve.components
        de = np.ascontiguousarray(dstrain, dtype=float)
        if de.shape != (len(self), n):
            raise ValueError("dstrain must be (%d, %d), got %s" % (len(self), n, de.shape))
        stress, tangent = np.empty(de.shape), np.empty((len(self), n, n))
        pointer = [ffi.cast("double *", a.ctypes.data) for a in (de, stress, tangent)]
        _call(lambda ctx, err: lib.ph_fe2_update_all(self._array, len(self), pointer[0], dt, pointer[1], pointer[2], ctx,
                                                     err), threads, progress, lambda: None)
        return stress, tangent

    def accept(self, threads: int = 0) -> None:
        """Take the increment that was tried last."""
        _call(lambda ctx, err: lib.ph_fe2_accept_all(self._array, len(self), ctx, err), threads, None, lambda: None)

    def reject(self) -> None:
        """Forget it."""
        for c in self._c:
            lib.ph_fe2_reject(c)

    def _states(self):
        state, err = ffi.new("ph_fe2_state *"), ffi.new("ph_error *")
        for c in self._c:
            _check(lib.ph_fe2_point_state(c, state, err), err)
            yield state

    @property
    def strain(self) -> np.ndarray:
        """[points][n] accepted."""
        return np.array([list(s.strain)[:self.rve.components] for s in self._states()])

    @property
    def stress(self) -> np.ndarray:
        """[points][n] accepted."""
        return np.array([list(s.stress)[:self.rve.components] for s in self._states()])

    @property
    def time(self) -> np.ndarray:
        """[points] sum of the accepted dt."""
        return np.array([s.time for s in self._states()])

    @property
    def broken_bonds(self) -> np.ndarray:
        """[points] by their history, without initial cracks."""
        return np.array([s.broken_bonds for s in self._states()])

    @property
    def dissipated(self) -> np.ndarray:
        """Energy per volume that breaking took."""
        return np.array([s.dissipated for s in self._states()])

    def save(self) -> List[bytes]:
        """The accepted states; a restart from there has the same bits."""
        out, err = [], ffi.new("ph_error *")
        for c in self._c:
            memory = ffi.new("char[]", lib.ph_fe2_point_bytes(c))
            _check(lib.ph_fe2_point_save(c, memory, len(memory), err), err)
            out.append(bytes(ffi.buffer(memory)))
        return out

    def restore(self, saved: Sequence[bytes]) -> None:
        """States that `save` gave, one a point, of the same RVE."""
        if len(saved) != len(self):
            raise ValueError("%d states for %d points" % (len(saved), len(self)))
        err = ffi.new("ph_error *")
        for c, memory in zip(self._c, saved):
            _check(lib.ph_fe2_point_restore(c, ffi.from_buffer(memory), len(memory), err), err)
