# SPDX-License-Identifier: GPL-3.0-or-later
"""Effective properties of composites from their microstructure.

    import perihom
    result = perihom.run("boron-aluminium.yaml")
    result.stiffness          # Voigt 11 22 33 23 13 12, engineering shear
    result.engineering["E1"]

The effective material in a macroscale code: MaterialPoint(result) updates many integration
points at once; FE2(micro) has an RVE at each of them. Tensors are NumPy arrays in Voigt order with engineering shear (2D: 11 22 12). Fields and the
phases of a microstructure are views of the memory of the library: no copies, alive as long as
their object. Long calls release the interpreter, so threads may solve different problems.
"""
from __future__ import annotations

import html
import json
import os
import resource
import tempfile
from typing import Any, Callable, Iterable, Mapping, Optional, Sequence, Union

import numpy as np

from ._base import Error, _check, _owned, _take_text, _text, _view, _voigt
from ._effective import DamageLaw, Effective, MaterialPoint, Series
from ._fe2 import FE2, Points
from ._perihom import ffi, lib
from ._solve import _call, _problem

__all__ = ["Case", "DamageLaw", "Effective", "Error", "FE2", "Fields", "Material", "MaterialPoint", "Microstructure",
           "Points", "Relaxation", "Result", "Series", "Superelement", "card", "catalogue", "catalogues", "homogenise",
           "relaxation", "run", "version"]

_KINEMATICS = ("space", "generalised_strain", "strain", "stress")

version = ffi.string(lib.ph_version()).decode()


# ---- materials ---------------------------------------------------------------------------


class Material:
    """A phase. Use the constructors Material.isotropic, .anisotropic and .void."""

    def __init__(self, handle):
        self._c = handle

    @classmethod
    def isotropic(cls, name: str, E: float, nu: float, density: Optional[float] = None) -> "Material":
        """Young's modulus E > 0 and Poisson's ratio -1 < nu < 1/2."""
        c, err = ffi.new("ph_material *"), ffi.new("ph_error *")
        _check(lib.ph_material_isotropic(name.encode(), E, nu, c, err), err)
        return cls._with_density(c, density)

    @classmethod
    def anisotropic(cls, name: str, stiffness, rotation=None, density: Optional[float] = None) -> "Material":
        """stiffness 6 x 6 Voigt 11 22 33 23 13 12, engineering shear, positive definite;
        rotation 3 x 3 applied to it."""
        c, err = ffi.new("ph_material *"), ffi.new("ph_error *")
        D = np.ascontiguousarray(stiffness, dtype=float)
        if D.shape != (6, 6):
            raise ValueError("stiffness must be 6 x 6, got %s" % (D.shape,))
        R = ffi.NULL
        if rotation is not None:
            turn = np.ascontiguousarray(rotation, dtype=float)
            if turn.shape != (3, 3):
                raise ValueError("rotation must be 3 x 3, got %s" % (turn.shape,))
            R = ffi.cast("double *", turn.ctypes.data)
        _check(lib.ph_material_anisotropic(name.encode(), ffi.cast("double *", D.ctypes.data), R, c, err), err)
        return cls._with_density(c, density)

    @classmethod
    def viscoelastic(cls, name: str, E=None, nu: Optional[float] = None, bulk=None, shear=None, series=None,
                     density: Optional[float] = None) -> "Material":
        """A phase that relaxes: E and nu, or bulk and shear, each modulus a pair (at infinity,
        [(time, modulus), ...]); or series, a Series of 6 x 6 tensors."""
        c, err, word = ffi.new("ph_material *"), ffi.new("ph_error *"), name.encode()
        if series is not None:
            _check(lib.ph_material_viscoelastic_tensor(word, series._c, ffi.NULL, c, err), err)
        elif E is not None and nu is not None:
            m, _keep = _modulus(E)
            _check(lib.ph_material_viscoelastic_young(word, m, nu, c, err), err)
        elif bulk is not None and shear is not None:
            (K, _keep), (G, _keep_too) = _modulus(bulk), _modulus(shear)
            _check(lib.ph_material_viscoelastic_bulk_shear(word, K, G, c, err), err)
        else:
            raise ValueError("give E and nu, bulk and shear, or series")
        return cls._with_density(ffi.gc(c, lib.ph_material_clear), density)

    @classmethod
    def void(cls, name: str) -> "Material":
        """A hole."""
        return cls(ffi.new("ph_material *", lib.ph_material_void(name.encode())))

    @classmethod
    def _with_density(cls, c, density):
        if density is not None:
            c.density = density
        return cls(c)

    @property
    def name(self) -> str:
        """As given."""
        return _text(self._c.name)

    @property
    def stiffness(self) -> np.ndarray:
        """Of a viscoelastic phase the instantaneous one."""
        return _voigt(self._c.stiffness)

    def __repr__(self):
        return "Material(%r)" % self.name


def _modulus(value):
    """A ph_modulus and the array that it borrows."""
    infinity, terms = value
    array = ffi.new("ph_modulus_term[]", max(1, len(terms)))
    for i, (time, modulus) in enumerate(terms):
        array[i].time, array[i].modulus = time, modulus
    return ffi.new("ph_modulus *", {"infinity": infinity, "nterms": len(terms), "term": array}), array


# ---- microstructures ---------------------------------------------------------------------


class Microstructure:
    """Which material is where: a periodic box of equal cells.

    materials: list of Material; phase: array of indices into it, shape (n0, n1) or (n0, n1, n2);
    size: of the box; plane (2D): "generalised_strain", "strain" or "stress".
    """

    def __init__(self, materials: Sequence[Material], phase, size: Optional[Sequence[float]] = None,
                 plane: str = "generalised_strain"):
        values = np.asarray(phase)
        if values.ndim not in (2, 3):
            raise ValueError("phase must have 2 or 3 axes, got %d" % values.ndim)
        if values.dtype.kind not in "iub":
            raise ValueError("phase must hold whole numbers, got %s" % values.dtype)
        if values.size == 0:
            raise ValueError("phase is empty")
        if values.min() < 0 or values.max() >= len(materials):
            raise ValueError("phase must be 0 to %d, found %d to %d" % (len(materials) - 1, values.min(), values.max()))
        if plane not in _KINEMATICS[1:]:
            raise ValueError("plane must be generalised_strain, strain or stress, got %r" % plane)
        if size is not None and len(size) != values.ndim:
            raise ValueError("size must have %d entries" % values.ndim)
        kin = 0 if values.ndim == 3 else _KINEMATICS.index(plane)
        err = ffi.new("ph_error *")
        grid = ffi.new("ph_grid *")
        lengths = [float(x) for x in (size if size is not None else [1.0] * values.ndim)]
        _check(lib.ph_grid_init(grid, kin, ffi.new("ptrdiff_t[]", list(values.shape)), ffi.new("double[]", lengths),
                                err), err)
        table = ffi.new("ph_material[]", max(1, len(materials)))
        for i, m in enumerate(materials):
            table[i] = m._c[0]
        out = ffi.new("ph_microstructure **")
        _check(lib.ph_microstructure_new(grid, len(materials), table, out, err), err)
        self._own(out[0])
        self.phase[...] = values

    def _own(self, pointer):
        self._c = ffi.gc(pointer, lambda p: lib.ph_microstructure_free(ffi.new("ph_microstructure **", p)))

    @classmethod
    def _wrap(cls, pointer) -> "Microstructure":
        self = cls.__new__(cls)
        self._own(pointer)
        return self

    @property
    def shape(self) -> tuple:
        """Cells along each axis."""
        n = self._c.grid.n
        return (n[0], n[1], n[2]) if self._c.grid.kinematics == 0 else (n[0], n[1])

    @property
    def kinematics(self) -> str:
        """space, generalised_strain, strain or stress"""
        return _KINEMATICS[self._c.grid.kinematics]

    @property
    def size(self) -> tuple:
        """Lengths of the box."""
        return tuple(self._c.grid.size[i] for i in range(len(self.shape)))

    @property
    def phase(self) -> np.ndarray:
        """Material of each cell: a view that may be written to."""
        return _view(self._c, self._c.phase, "uint16_t", self.shape)

    @property
    def owner(self) -> Optional[np.ndarray]:
        """Filler of each cell, from 1; 0: none. None where no fillers were placed."""
        return None if self._c.owner == ffi.NULL else _view(self._c, self._c.owner, "int32_t", self.shape)

    @property
    def fractions(self) -> dict:
        """Volume fraction of each material, cut cells counted with their parts."""
        f = ffi.new("double[]", self._c.nmaterials)
        lib.ph_microstructure_fractions(self._c, f)
        return {_text(self._c.materials[i].name): f[i] for i in range(self._c.nmaterials)}

    def write_png(self, path: Union[str, os.PathLike], axis: int = 3, title: str = "") -> None:
        """A picture of the phases; in 3D the middle slice normal to `axis`."""
        err = ffi.new("ph_error *")
        _check(lib.ph_write_phases_png(os.fsencode(path), self._c, axis, title.encode("ascii", "replace"), err), err)

    def _repr_png_(self) -> bytes:
        return _picture(self.write_png)

    def __repr__(self):
        return "Microstructure(%s, %s)" % (" x ".join(map(str, self.shape)), self.fractions)


def _picture(write: Callable) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "picture.png")
        write(path)
        with open(path, "rb") as f:
            return f.read()


# ---- cases -------------------------------------------------------------------------------


def _sets(sets: Optional[Mapping[str, Any]]):
    """C array of "key.path=value" and what keeps its texts alive."""
    texts = [ffi.new("char[]", ("%s=%s" % (k, v if isinstance(v, str) else json.dumps(v))).encode())
             for k, v in (sets or {}).items()]
    return ffi.new("const char *[]", texts + [ffi.NULL]), texts


class Case:
    """A case file, parsed and checked.

    Case("file.yaml", sets={"microstructure.nodes": [64, 64]}) or Case.parse(text) or, with
    the same keys as a dictionary, Case.from_dict({...}).
    """

    def __init__(self, path: Union[str, os.PathLike], sets: Optional[Mapping[str, Any]] = None):
        array, keep = _sets(sets)
        self._read(lambda out, issues, err: lib.ph_case_read(os.fsencode(path), array, len(keep), out, issues, err),
                   str(path))

    @classmethod
    def parse(cls, text: str, sets: Optional[Mapping[str, Any]] = None, name: str = "text") -> "Case":
        """From the text of a case file."""
        self = cls.__new__(cls)
        array, keep = _sets(sets)
        data = text.encode()
        self._read(lambda out, issues, err: lib.ph_case_parse(data, len(data), name.encode(), array, len(keep), out,
                                                              issues, err), name)
        return self

    @classmethod
    def from_dict(cls, case: Mapping[str, Any], sets: Optional[Mapping[str, Any]] = None) -> "Case":
        """From a dictionary with the keys of a case file."""
        return cls.parse(json.dumps(case), sets, "case")

    def _read(self, call, name):
        out, issues, err = ffi.new("ph_case **"), ffi.new("ph_case_issues *"), ffi.new("ph_error *")
        status = call(out, issues, err)
        texts = []
        line = ffi.new("char[]", 1024)
        for i in range(issues.count):
            lib.ph_case_issue_text(ffi.addressof(issues.item[i]), name.encode(), line, 1024)
            texts.append(_text(line))
        lib.ph_case_issues_free(issues)
        _check(status, err, texts)
        self.warnings = texts
        self._c = ffi.gc(out[0], lambda p: lib.ph_case_free(ffi.new("ph_case **", p)))

    @property
    def title(self) -> str:
        """As the case file has it."""
        return _text(self._c.title)

    def to_dict(self) -> dict:
        """The resolved case: every default filled in."""
        out, err = ffi.new("char **"), ffi.new("ph_error *")
        _check(lib.ph_case_to_json(self._c, out, err), err)
        return json.loads(_take_text(out))

    def microstructure(self, realisation: Optional[int] = None) -> Microstructure:
        """Shapes and random fillers painted; `realisation` counts the random ones of a seed."""
        if realisation is not None:
            self._c.realisation = realisation
        out, err = ffi.new("ph_microstructure **"), ffi.new("ph_error *")
        _check(lib.ph_rve_build(self._c, out, err), err)
        return Microstructure._wrap(out[0])

    def relaxation(self, realisation: Optional[int] = None, **options) -> "Relaxation":
        """Build and solve for the effective relaxation; options as those of `relaxation`."""
        return relaxation(self.microstructure(realisation), case=self, **options)

    def run(self, realisation: Optional[int] = None, **options) -> "Result":
        """Build and solve; options as those of `homogenise` that are not the case's.

        error_bar: solve the companions of the case too, see `Result.error_bar`.
        A case with `accuracy` is solved on the grids that reach it, options threads and progress;
        Error with exit code 4 where none does. `homogenise` solves its grid as it is.
        """
        if self._c.accuracy.relative > 0:
            if realisation is not None:
                self._c.realisation = realisation
            return self._to_accuracy(**options)
        return homogenise(self.microstructure(realisation), case=self, **options)

    def _to_accuracy(self, threads: int = 0, progress=None, error_bar: bool = False, **settings) -> "Result":
        if settings:
            raise ValueError("accuracy chooses settings: give %s in the case" % ", ".join(sorted(settings)))
        mine = ffi.new("ph_case *", self._c[0])  # borrows the arrays
        if mine.accuracy.memory == 0:
            mine.accuracy.memory = _memory_here()
        out = ffi.new("ph_fidelity **")
        _call(lambda ctx, err: lib.ph_fidelity_solve(mine, ctx, out, err), threads, progress,
              lambda: lib.ph_fidelity_free(out))
        return Result._of_search(out[0], self)

    def __repr__(self):
        return "Case(%r)" % self.title


def _memory_here() -> float:
    """Bytes that a solve may take: those of the machine, or the limit of the process."""
    here = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    return float(here if limit == resource.RLIM_INFINITY else min(here, limit))


# ---- results -----------------------------------------------------------------------------


class Fields:
    """Fields of one load case, per unit of its macro strain; views without copies.

    strain, stress: [component][cell ...] in Voigt order, engineering shear;
    displacement: [axis][cell ...], the total one.
    """

    def __init__(self, owner, c, shape):
        self.load = c.load
        self.macro_strain = np.array([c.macro_strain[i] for i in range(c.ns)])
        self.displacement = _view(owner, c.displacement, "double", (c.nu, *shape))
        self.strain = _view(owner, c.strain, "double", (c.ns, *shape))
        self.stress = _view(owner, c.stress, "double", (c.ns, *shape))


class Result:
    """What a solve gave. What belongs to no load that was solved is NaN in `stiffness`."""

    def __init__(self, pointer, case: Optional[Case], micro: Microstructure):
        self._c = _owned(pointer, "ph_result", lib.ph_result_free)
        self._case = case
        self._shape = micro.shape
        self._fidelity = None

    @classmethod
    def _of_search(cls, pointer, case: Case) -> "Result":
        """Of a search for settings, which owns it."""
        self = cls.__new__(cls)
        owner = _owned(pointer, "ph_fidelity", lib.ph_fidelity_free)
        self._c = ffi.gc(pointer.result, lambda p, owner=owner: None)  # views hold on to it
        self._case, self._fidelity = case, owner
        nodes = pointer.nodes
        self._shape = tuple(nodes[i] for i in range(3 if self._c.grid.kinematics == 0 else 2))
        return self

    def _need_all_loads(self):
        missing = [a for a in range(self._c.stiffness.n) if not self._c.loads >> a & 1]
        if missing:
            raise Error("loads %s were not solved" % ", ".join(map(str, missing)), lib.PH_EINVAL)

    @property
    def stiffness(self) -> np.ndarray:
        """Effective stiffness, Voigt, engineering shear, units of the case."""
        D = _voigt(self._c.stiffness)
        missing = np.array([not self._c.loads >> a & 1 for a in range(len(D))])
        D[:, missing] = D.T[:, missing]  # the tensor is symmetric
        D[np.ix_(missing, missing)] = np.nan
        return D

    @property
    def compliance(self) -> np.ndarray:
        """Inverse of the stiffness, Voigt; of constants that took a mean stress each, its columns, others NaN."""
        if self._c.stresses:
            S = _voigt(self._c.compliance, False)
            S[:, [not self._c.stresses >> a & 1 for a in range(len(S))]] = np.nan
            return S
        self._need_all_loads()
        inverse, err = ffi.new("ph_sym4 *"), ffi.new("ph_error *")
        _check(lib.ph_sym4_inverse(ffi.new("ph_sym4 *", self._c.stiffness), inverse, err), err)
        return _voigt(inverse[0], False)

    @property
    def engineering(self) -> dict:
        """E1 E2 E3 nu12 ... G12 of the effective tensor, those that there are."""
        self._need_all_loads()
        e, err = ffi.new("ph_engineering *"), ffi.new("ph_error *")
        _check(lib.ph_engineering_constants(ffi.new("ph_sym4 *", self._c.stiffness), e, err), err)
        out = {"E%d" % (i + 1): e.E[i] for i in range(3)}
        out.update({"nu%d%d" % (i + 1, j + 1): e.nu[i][j] for i in range(3) for j in range(3) if i != j})
        out.update(G23=e.G23, G13=e.G13, G12=e.G12)
        return {k: v for k, v in out.items() if v == v}

    @property
    def isotropic(self) -> dict:
        """E nu K G of the nearest isotropic tensor, and how far it is."""
        self._need_all_loads()
        iso = lib.ph_nearest_isotropic(ffi.new("ph_sym4 *", self._c.stiffness), self._c.grid.kinematics)
        return {"E": iso.E, "nu": iso.nu, "K": iso.K, "G": iso.G, "distance": iso.distance}

    @property
    def voigt(self) -> np.ndarray:
        """Upper bound: mean stiffness."""
        return _voigt(self._c.voigt)

    @property
    def reuss(self) -> np.ndarray:
        """Lower bound: inverse of the mean compliance; zero with a void phase."""
        return _voigt(self._c.reuss)

    @property
    def fractions(self) -> dict:
        """Volume fraction of each material."""
        return {_text(self._c.names[i]): self._c.fractions[i] for i in range(self._c.nmaterials)}

    @property
    def quality(self) -> dict:
        """How far averages and energies agree."""
        return {"hill_mandel": self._c.hill_mandel, "strain_average": self._c.strain_average,
                "asymmetry": self._c.asymmetry, "stabilisation_energy": self._c.stabilisation_energy}

    def _error_constants(self):
        bar = self._c.error_bar
        return [bar.constant[i] for i in range(bar.count)] if bar != ffi.NULL else []

    @property
    def error_bar(self) -> dict:
        """Relative error (95 %) of every constant that has one; empty unless asked for (`error_bar=True`)."""
        return {_text(k.name): k.bar for k in self._error_constants() if k.bar == k.bar}

    @property
    def error_parts(self) -> dict:
        """What it consists of: part -> constant -> relative error."""
        names = [_text(lib.ph_error_parts[i].info.name) for i in range(lib.ph_nerror_parts)]
        return {name: {_text(k.name): k.part[i] for k in self._error_constants() if k.part[i] == k.part[i]}
                for i, name in enumerate(names)}

    @property
    def richardson(self) -> dict:
        """Constants extrapolated to spacing zero."""
        return {_text(k.name): k.richardson for k in self._error_constants() if k.richardson == k.richardson}

    @property
    def precision(self) -> str:
        """Of the solver's iterates: "double" or "single"."""
        return _text(self._c.precision)

    @property
    def iterations(self) -> list:
        """Of each load."""
        return [self._c.iterations[i] for i in range(self._c.nloads)]

    @property
    def cost(self) -> dict:
        """Seconds, bytes, threads."""
        w = self._c.work
        return {"seconds": self._c.seconds, "seconds_solve": self._c.seconds_solve, "threads": self._c.threads,
                "loads": w.loads, "iterations": w.iterations, "applications": w.applications, "ffts": w.ffts,
                "collar_nodes": w.collar, "history_variables": w.history_variables, "bond_bits": w.bond_bits,
                "peak_bytes": w.peak_bytes}

    @property
    def notes(self) -> list:
        """What `auto` chose and why, warnings."""
        return [_text(self._c.notes[i]) for i in range(self._c.nnotes)]

    @property
    def fields(self) -> list:
        """Fields of each load, where they were kept."""
        return [Fields(self._c, self._c.fields[i], self._shape) for i in range(self._c.nfields)]

    def quantity(self, name: str) -> float:
        """A scalar by name: "E1", "isotropic.K", "C12", "fraction.glass" ..."""
        q, err, value = ffi.new("ph_quantity *"), ffi.new("ph_error *"), ffi.new("double *")
        _check(lib.ph_quantity_find(name.encode(), q, err), err)
        _check(lib.ph_quantity_value(q, self._c, value, err), err)
        return value[0]

    def to_dict(self) -> dict:
        """The result document, schema perihom.result/1."""
        out, err = ffi.new("char **"), ffi.new("ph_error *")
        case = self._case._c if self._case else ffi.NULL
        if self._fidelity is not None:
            _check(lib.ph_fidelity_to_json(self._fidelity, case, ffi.NULL, out, err), err)
        else:
            _check(lib.ph_result_to_json(self._c, case, ffi.NULL, out, err), err)
        return json.loads(_take_text(out))

    @property
    def effective(self) -> Effective:
        """The effective material apart from its RVE."""
        out, err = ffi.new("ph_effective **"), ffi.new("ph_error *")
        case = self._case._c if self._case else ffi.NULL
        _check(lib.ph_effective_from_result(self._c, case, out, err), err)
        return Effective._wrap(out[0])

    def card(self, to: str, **options) -> str:
        """A material card, as the function `card`."""
        return self.effective.card(to, **options)

    def _constants(self) -> tuple:
        """Engineering constants, or none and why."""
        try:
            return self.engineering, ""
        except Error as error:
            return {}, "no engineering constants: %s" % error

    def _repr_html_(self) -> str:
        constants, why = self._constants()
        rows = list(constants.items()) or self.stiffness
        text = "".join("<tr>%s</tr>" % "".join("<td>%s</td>" % (x if isinstance(x, str) else "%.6g" % x) for x in row)
                       for row in rows)
        return "<table>%s</table>%s" % (text, "<p>%s</p>" % html.escape(why) if why else "")

    def __repr__(self):
        constants, why = self._constants()
        if why:
            return "Result(stiffness\n%s\n%s)" % (self.stiffness, why)
        return "Result(%s)" % ", ".join("%s %.4g" % item for item in constants.items() if item[0][0] in "EG")


# ---- solving -----------------------------------------------------------------------------

def homogenise(micro: Microstructure, case: Optional[Case] = None, model: Optional[str] = None,
               points: Optional[str] = None, horizon: Optional[float] = None, constraint: Optional[str] = None,
               solver: Optional[str] = None, interface: Optional[str] = None, tolerance: Optional[float] = None,
               loads: Optional[Iterable[int]] = None, fields: Optional[bool] = None, threads: int = 0,
               progress: Optional[Callable[[int, int, int, float], Any]] = None, error_bar: bool = False,
               precision: Optional[str] = None) -> Result:
    """Effective stiffness of a microstructure.

    case: where settings come from that are not given here; without it, the defaults.
    model, points, horizon (in spacings), constraint, solver, interface, tolerance, precision ("double",
    "single" or "auto"): as in a case file.
    loads: macro strains 0 .. 5 to solve, default all; fields: keep displacement, strain, stress.
    progress(load, loads, iteration, residual): called each iteration; False stops.
    error_bar: solve the companions of `case`, which `micro` must be of, see `Result.error_bar`.
    Raises Error; Ctrl-C, and what `progress` raises, stops the solve within an iteration and is raised again.
    """
    if error_bar and case is None:
        raise ValueError("error bars are those of a case: a coarser grid is built from it")
    problem, _keep = _problem(micro, case, model, points, horizon, constraint, solver, interface, tolerance,
                              precision, loads, fields)
    out = ffi.new("ph_result **")

    def solve(ctx, err):
        status = lib.ph_homogenise(problem, ctx, out, err)
        if error_bar and status == 0:
            status = lib.ph_rve_error_bar(case._c, problem, ctx, out[0], err)
        return status
    _call(solve, threads, progress, lambda: lib.ph_result_free(out))
    return Result(out[0], case, micro)


def relaxation(micro: Microstructure, case: Optional[Case] = None, route: Optional[str] = None,
               tolerance: Optional[float] = None, threads: int = 0,
               progress: Optional[Callable[[int, int, int, float], Any]] = None, **settings) -> "Relaxation":
    """Effective relaxation of a microstructure with materials that relax.

    route: of the catalogue "routes"; tolerance: relative error of the effective tensor, default
    that of the case, else 1e-4; settings: model, points, horizon, constraint, solver, interface, precision.
    """
    names = ("model", "points", "horizon", "constraint", "solver", "interface", "precision")
    unknown = set(settings) - set(names)
    if unknown:
        raise TypeError("relaxation has no setting %s" % ", ".join(sorted(unknown)))
    problem, _keep = _problem(micro, case, **settings)
    params = ffi.new("ph_relaxation_params *")
    word = ffi.new("char[]", (route or "").encode())
    if case is not None and case._c.viscoelastic.given:
        params.route, params.tolerance = case._c.viscoelastic.route, case._c.viscoelastic.tolerance
    if route is not None:
        params.route = word
    if tolerance is not None:
        params.tolerance = tolerance
    out = ffi.new("ph_viscoelastic **")
    _call(lambda ctx, err: lib.ph_viscoelastic_solve(problem, params, ctx, out, err), threads, progress,
          lambda: lib.ph_viscoelastic_free(out))
    return Relaxation(out[0], case)


class Relaxation:
    """What the solve of a relaxation gave.

    series: Series of the effective tensor, None where the route has none; error: its estimated
    relative error; solved: Carson variables that were solved.
    """

    def __init__(self, pointer, case: Optional[Case]):
        self._c = _owned(pointer, "ph_viscoelastic", lib.ph_viscoelastic_free)
        self._case = case
        self.error = pointer.error
        self.solved = [pointer.points[i].s for i in range(pointer.npoints)]
        self.iterations = pointer.iterations
        self.instantaneous, self.equilibrium = _voigt(pointer.instantaneous), _voigt(pointer.equilibrium)
        self.series = None if pointer.series == ffi.NULL else Series._copy(pointer.series)

    @property
    def effective(self) -> Effective:
        """The effective material apart from its RVE, with its series."""
        out, err = ffi.new("ph_effective **"), ffi.new("ph_error *")
        case = self._case._c if self._case else ffi.NULL
        _check(lib.ph_effective_from_result(self._c.elastic, case, out, err), err)
        return Effective._wrap(out[0], self.series)


class Superelement:
    """The RVE condensed to the nodes that it shares with its neighbours (docs/theory/superelement.md).

    Superelement(micro): finite elements, whose nodes are on the faces; model "nosb" or "bond", with
    points, horizon, interface as of homogenise: a boundary volume as thick as the family.
    position: [node][3] from the lower corner; stiffness: [n][n], row components * node + axis,
    a view; in generalised plane strain one more row, the macro strain 33 (strains = 1); linear,
    periodic: the effective stiffness with u = eps x on what is kept, and periodic.
    """

    def __init__(self, micro: Microstructure, interface: Optional[str] = None, threads: int = 0, model: str = "local",
                 points: Optional[str] = None, horizon: Optional[float] = None):
        problem, _keep = _problem(micro, None, model, points, horizon, interface=interface)
        out = ffi.new("ph_superelement **")
        _call(lambda ctx, err: lib.ph_superelement_new(problem, ctx, out, err), threads, None,
              lambda: lib.ph_superelement_free(out))
        self._c = _owned(out[0], "ph_superelement", lib.ph_superelement_free)
        self.components, self.condensed, self.strains = self._c.nd, self._c.condensed, self._c.strains
        n = self._c.nodes * self._c.nd + self._c.strains
        self.position = _view(self._c, self._c.position, "double", (self._c.nodes, 3))
        self.stiffness = _view(self._c, self._c.stiffness, "double", (n, n))
        self.linear, self.periodic = _voigt(self._c.linear), _voigt(self._c.periodic)

    def to_mtx(self) -> str:
        """Matrix Market text."""
        out, err = ffi.new("char **"), ffi.new("ph_error *")
        _check(lib.ph_superelement_to_mtx(self._c, out, err), err)
        return _take_text(out)

    def write_h5(self, path: Union[str, os.PathLike]) -> None:
        """HDF5: stiffness/data, indices, indptr as of scipy.sparse.csr_matrix, position, linear, periodic."""
        err = ffi.new("ph_error *")
        _check(lib.ph_superelement_write_h5(self._c, os.fspath(path).encode(), err), err)


def run(path: Union[str, os.PathLike], sets: Optional[Mapping[str, Any]] = None, **options) -> Result:
    """Read a case file, build its microstructure and solve it."""
    return Case(path, sets).run(**options)


# ---- cards and catalogues ----------------------------------------------------------------


def card(result: Union[str, os.PathLike], to: str, **options) -> str:
    """The material card of a result folder or result.json for another code.

    to: "abaqus", "calculix" ... (catalogue "formats"); options: name, id, symmetry
    ("isotropic", "orthotropic", "anisotropic"), nearest.
    """
    return Effective.read(result).card(to, **options)


def _all_catalogues():
    c = lib.ph_catalogues()
    i = 0
    while c[i].name != ffi.NULL:
        yield c[i]
        i += 1
    yield lib.ph_card_formats()[0]


def catalogues() -> dict:
    """The catalogues of this build: name and title."""
    return {_text(c.name): _text(c.title) for c in _all_catalogues()}


def catalogue(name: str) -> list:
    """The entries of a catalogue, e.g. "models"."""
    for c in _all_catalogues():
        if _text(c.name) == name:
            entries = [lib.ph_catalogue_entry(ffi.new("ph_catalogue *", c), i) for i in range(c.count[0])]
            return [{k: _text(getattr(e, k)) for k in ("name", "title", "reference", "valid")} for e in entries]
    raise ValueError("no catalogue %r; there are %s" % (name, ", ".join(catalogues())))
