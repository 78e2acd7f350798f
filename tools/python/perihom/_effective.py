# SPDX-License-Identifier: GPL-3.0-or-later
"""The effective material apart from its RVE: its tensor or series, and the material point."""
from __future__ import annotations

import os
from typing import Any, Optional, Sequence, Tuple, Union

import numpy as np

from ._base import _check, _enum, _mandel, _owned, _take_text, _text, _voigt
from ._perihom import ffi, lib

_KINEMATICS = ("space", "generalised_strain", "strain", "stress")
_SYMMETRY = {None: 0, "isotropic": 1, "orthotropic": 2, "anisotropic": 3}


class Series:
    """A relaxation tensor as a Prony series, C(t) = equilibrium + sum stiffness_m exp(-t / time_m).

    Series(equilibrium, [(time, stiffness), ...]) with Voigt matrices; time and stiffness are
    arrays [terms] and [terms][n][n].
    """

    def __init__(self, equilibrium, terms: Sequence[Tuple[float, Any]]):
        first = ffi.new("ph_sym4 *", _mandel(equilibrium, "equilibrium"))
        array = ffi.new("ph_prony_term[]", max(1, len(terms)))
        for i, (time, stiffness) in enumerate(terms):
            array[i].time, array[i].stiffness = time, _mandel(stiffness)
        out, err = ffi.new("ph_prony **"), ffi.new("ph_error *")
        _check(lib.ph_prony_new(first, len(terms), array, out, err), err)
        self._own(out[0])

    def _own(self, pointer):
        self._c = _owned(pointer, "ph_prony", lib.ph_prony_free)
        self.equilibrium = _voigt(pointer.equilibrium)
        self.time = np.array([pointer.term[i].time for i in range(pointer.nterms)])
        self.stiffness = np.array([_voigt(pointer.term[i].stiffness) for i in range(pointer.nterms)]).reshape(
            (pointer.nterms,) + self.equilibrium.shape)

    @classmethod
    def _copy(cls, pointer) -> "Series":
        out, err = ffi.new("ph_prony **"), ffi.new("ph_error *")
        _check(lib.ph_prony_copy(pointer, out, err), err)
        self = cls.__new__(cls)
        self._own(out[0])
        return self

    @property
    def instantaneous(self) -> np.ndarray:
        """C(0+), Voigt."""
        return _voigt(lib.ph_prony_instantaneous(self._c))

    def at(self, time: float) -> np.ndarray:
        """C(t), t >= 0; inf: equilibrium."""
        if not time >= 0:
            raise ValueError("time must be >= 0, got %r" % time)
        return _voigt(lib.ph_prony_at_time(self._c, time))

    def complex(self, omega: float) -> np.ndarray:
        """Storage + i loss at an angular frequency."""
        re, im = ffi.new("ph_sym4 *"), ffi.new("ph_sym4 *")
        lib.ph_prony_complex(self._c, omega, re, im)
        return _voigt(re[0]) + 1j * _voigt(im[0])

    def compress(self, terms: Optional[int] = None, tolerance: float = 1e-3) -> Tuple["Series", float]:
        """A series of at most so many terms, or (None) as few as the tolerance needs, and its error."""
        if terms is not None and terms < 1:
            raise ValueError("terms must be >= 1, or None, got %r" % terms)
        out, error, err = ffi.new("ph_prony **"), ffi.new("double *"), ffi.new("ph_error *")
        _check(lib.ph_prony_compress(self._c, terms or 0, tolerance, out, error, err), err)
        self = Series.__new__(Series)
        self._own(out[0])
        return self, error[0]

    def __len__(self):
        return len(self.time)


class DamageLaw:
    """Stiffness against one damage variable, and the loads that drive it (docs/material-point.md).

    DamageLaw(strain, damage, stiffness, begin, end): direction of the load [n], d of the knots
    [knots], Voigt matrices [knots][n][n], load factors of the segments [knots - 1].
    """

    def __init__(self, strain, damage, stiffness, begin, end):
        out, err = ffi.new("ph_damage_law **"), ffi.new("ph_error *")
        tensors = [_mandel(c) for c in stiffness]
        damage, begin, end = [float(d) for d in damage], [float(x) for x in begin], [float(x) for x in end]
        if len(tensors) != len(damage) or len(begin) + 1 != len(damage) or len(end) + 1 != len(damage):
            raise ValueError("a damage law needs as many stiffnesses as damage, and one load less")
        _check(lib.ph_damage_law_new(len(strain), ffi.new("double[]", [float(e) for e in strain]), len(damage),
                                     ffi.new("double[]", damage), ffi.new("ph_sym4[]", tensors),
                                     ffi.new("double[]", begin), ffi.new("double[]", end), out, err), err)
        self._own(out[0])

    def _own(self, pointer):
        self._c = _owned(pointer, "ph_damage_law", lib.ph_damage_law_free)
        knots = pointer.nknots
        self.strain = np.array(list(pointer.strain[0:pointer.n]))
        self.damage = np.array(list(pointer.damage[0:knots]))
        self.stiffness = np.array([_voigt(pointer.stiffness[k]) for k in range(knots)])
        self.begin, self.end = (np.array(list(x[0:knots - 1])) for x in (pointer.begin, pointer.end))
        self.correction = pointer.correction

    @classmethod
    def _copy(cls, pointer) -> "DamageLaw":
        out, err = ffi.new("ph_damage_law **"), ffi.new("ph_error *")
        _check(lib.ph_damage_law_copy(pointer, out, err), err)
        self = cls.__new__(cls)
        self._own(out[0])
        return self

    @classmethod
    def from_growth(cls, result, strain, fracture_energy: float) -> "DamageLaw":
        """Of a Result of prescribed cracks, which grow when they release the fracture energy."""
        strain = [float(e) for e in strain]
        if len(strain) != result.stiffness.shape[0]:
            raise ValueError("strain must have %d components" % result.stiffness.shape[0])
        out, err = ffi.new("ph_damage_law **"), ffi.new("ph_error *")
        _check(lib.ph_damage_law_from_growth(result._c, ffi.new("double[]", strain), fracture_energy, out, err), err)
        self = cls.__new__(cls)
        self._own(out[0])
        return self

    def at(self, damage: float) -> np.ndarray:
        """C(d), Voigt, 0 <= d <= 1."""
        if not 0 <= damage <= 1:
            raise ValueError("damage must be 0 to 1, got %r" % damage)
        return _voigt(lib.ph_damage_law_stiffness(self._c, damage))

    def force(self, damage: float, strain) -> float:
        """Thermodynamic force -1/2 strain : dC/dd : strain."""
        if len(strain) != len(self.strain):
            raise ValueError("strain must have %d components" % len(self.strain))
        return lib.ph_damage_law_force(self._c, damage, ffi.new("double[]", [float(e) for e in strain]))


class Effective:
    """An effective material: `stiffness` (of a viscoelastic one the instantaneous one),
    `relaxation`, a Series or None, and `damage`, a DamageLaw or None (`stiffness` is then the
    last one). From Effective.read(path), result.effective or, by hand, Effective(stiffness),
    Effective(series) and Effective(law)."""

    def __init__(self, material: Union[Series, DamageLaw, Any]):
        series = material if isinstance(material, Series) else None
        law = material if isinstance(material, DamageLaw) else None
        stiffness = series.instantaneous if series else law.stiffness[-1] if law else material
        c = ffi.new("ph_effective *")
        c.stiffness = _mandel(stiffness)
        c.kinematics = 0 if c.stiffness.n == 6 else 2
        c.density = float("nan")
        self._set(c, series, law)

    def _set(self, c, series, law=None):
        self._c, self.relaxation, self.damage = c, series, law
        c.damage = law._c if law is not None else ffi.NULL
        if series is not None:
            c.relaxation, c.stiffness = series._c, lib.ph_prony_instantaneous(series._c)

    @classmethod
    def _wrap(cls, pointer, series: Optional[Series] = None) -> "Effective":
        """Takes a ph_effective, as a plain copy whose series is ours."""
        owner = _owned(pointer, "ph_effective", lib.ph_effective_free)
        if series is None and pointer.relaxation != ffi.NULL:
            series = Series._copy(pointer.relaxation)
        law = DamageLaw._copy(pointer.damage) if pointer.damage != ffi.NULL else None
        c = ffi.new("ph_effective *", owner[0])
        c.relaxation = ffi.NULL
        self = cls.__new__(cls)
        self._set(c, series, law)
        return self

    @classmethod
    def read(cls, path: Union[str, os.PathLike]) -> "Effective":
        """From a result.json or the folder that holds one."""
        out, err = ffi.new("ph_effective **"), ffi.new("ph_error *")
        _check(lib.ph_effective_read(os.fsencode(path), out, err), err)
        return cls._wrap(out[0])

    @property
    def stiffness(self) -> np.ndarray:
        """Voigt, engineering shear."""
        return _voigt(self._c.stiffness)

    @property
    def title(self) -> str:
        """Of the case."""
        return _text(self._c.title)

    @property
    def units(self) -> dict:
        """Labels of length, stress and time."""
        return {"length": _text(self._c.unit_length), "stress": _text(self._c.unit_stress),
                "time": _text(self._c.unit_time)}

    @property
    def kinematics(self) -> str:
        """"space", "generalised_strain", "strain" or "stress"."""
        return _KINEMATICS[self._c.kinematics]

    def card(self, to: str, name: str = "perihom", id: int = 1, symmetry: Optional[str] = None,
             nearest: bool = False) -> str:
        """A material card, as the function `card`."""
        word = ffi.new("char[]", name.encode())
        params = ffi.new("ph_card_params *", {"name": word, "id": id, "nearest": nearest,
                                              "symmetry": _enum("symmetry", symmetry, _SYMMETRY)})
        out, err = ffi.new("char **"), ffi.new("ph_error *")
        _check(lib.ph_card_write(self._c, to.encode(), params, out, ffi.NULL, err), err)
        return _take_text(out)


class MaterialPoint:
    """The effective material at the integration points of a macroscale code.

    MaterialPoint(material): an Effective, a Result, a Relaxation, a Series, a DamageLaw, a path of a result
    document or a Voigt matrix.

        point = perihom.MaterialPoint("resin-results")
        state = point.state(1000)                 # zeros, [points][state_size]: virgin
        stress, tangent = point.update(state, dstrain, dt)

    Never changes, so that threads may share it; the state is yours, saving it is a restart.
    """

    def __init__(self, material: Any):
        if isinstance(material, (str, os.PathLike)):
            material = Effective.read(material)
        elif not isinstance(material, Effective):
            material = getattr(material, "effective", None) or Effective(material)
        out, err = ffi.new("ph_point_material **"), ffi.new("ph_error *")
        _check(lib.ph_point_material_new(material._c, out, err), err)
        self._c = _owned(out[0], "ph_point_material", lib.ph_point_material_free)
        self.effective = material
        self.components = lib.ph_point_components(self._c)
        self.state_size = lib.ph_point_state_size(self._c)

    def state(self, points: int) -> np.ndarray:
        """The virgin state of so many points."""
        return np.zeros((points, self.state_size))

    def update(self, state: np.ndarray, dstrain: np.ndarray, dt: float, stress: Optional[np.ndarray] = None
               ) -> Tuple[np.ndarray, np.ndarray]:
        """One increment, the strain growing linearly over dt (a jump: 0).

        state: [points][state_size], updated in place; dstrain: [points][components], Voigt,
        engineering shear; stress: where to put it, or None. Contiguous arrays of doubles are
        used where they are. Returns stress [points][components] and the tangent
        [components][components], which is that of all points: it depends on dt alone; with a
        damage law [points][components][components].
        """
        de = np.ascontiguousarray(dstrain, dtype=float)
        points = de.size // self.components
        if de.shape[-1:] != (self.components,):
            raise ValueError("dstrain must be [points][%d], got %s" % (self.components, de.shape))
        if stress is None:
            stress = np.empty(de.shape)
        for name, array, size in (("state", state, self.state_size), ("stress", stress, self.components)):
            if not (isinstance(array, np.ndarray) and array.dtype == np.float64 and array.flags.c_contiguous
                    and array.flags.writeable and array.size == points * size):
                raise ValueError("%s must be a contiguous, writeable array of %d x %d doubles" % (name, points, size))
        if np.may_share_memory(stress, de):
            raise ValueError("stress and dstrain must not share memory")
        each = (points,) if self.effective.damage is not None else ()
        tangent = np.empty(each + (self.components, self.components))
        pointer = [ffi.cast("double *", a.ctypes.data) for a in (state, de, stress, tangent)]
        status = lib.ph_points_update(self._c, points, pointer[0], pointer[1], dt, pointer[2], pointer[3])
        if status:
            raise ValueError("dt must be finite and >= 0, and dstrain finite")
        return stress, tangent
