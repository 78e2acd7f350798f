# SPDX-License-Identifier: GPL-3.0-or-later
"""What the parts of the package share: errors, texts, tensors, views."""
from __future__ import annotations

from typing import Any, Mapping, Sequence

import numpy as np

from ._perihom import ffi, lib


class Error(Exception):
    """What the library says went wrong.

    status: a word such as "not converged"; exit_code: that of the program; issues: every
    complaint about a case file; iteration and residual of a solver that failed.
    """

    def __init__(self, message: str, status: int, iteration: int = 0, residual: float = 0.0,
                 issues: Sequence[str] = ()):
        super().__init__(message)
        self.status = ffi.string(lib.ph_status_text(status)).decode()
        self.exit_code = lib.ph_status_exit_code(status)
        self.iteration = iteration
        self.residual = residual
        self.issues = list(issues)


Error.__module__ = "perihom"


def _text(pointer) -> str:
    return ffi.string(pointer).decode("utf-8", "replace")


def _check(status: int, err, issues: Sequence[str] = ()) -> None:
    if status:
        raise Error(_text(err.msg) or ffi.string(lib.ph_status_text(status)).decode(), status, err.iteration,
                    err.residual, issues)


def _take_text(pointer) -> str:
    """A malloc'd text, released."""
    text = ffi.string(pointer[0]).decode()
    lib.free(pointer[0])
    return text


def _voigt(tensor, stiffness: bool = True) -> np.ndarray:
    n = tensor.n
    out = np.zeros((n, n))
    lib.ph_sym4_to_voigt(ffi.new("ph_sym4 *", tensor), stiffness, ffi.cast("double *", out.ctypes.data))
    return out


def _view(owner, pointer, ctype: str, shape: Sequence[int]) -> np.ndarray:
    """An array on the memory of `owner`, which it keeps alive."""
    n = int(np.prod(shape))
    array = np.frombuffer(ffi.buffer(ffi.cast(ctype + " *", pointer), n * ffi.sizeof(ctype)),
                          dtype={"double": np.float64, "uint16_t": np.uint16, "int32_t": np.int32}[ctype])
    return _Owned(array.reshape(shape), owner)


class _Owned(np.ndarray):
    """A view that holds on to the object whose memory it shows."""

    def __new__(cls, array: np.ndarray, owner: Any):
        self = array.view(cls)
        self._owner = owner
        return self

    def __array_finalize__(self, obj):
        self._owner = getattr(obj, "_owner", None)


def _enum(name: str, value: str, table: Mapping[str, int]) -> int:
    if value not in table:
        raise ValueError("%s must be one of %s, got %r" % (name, ", ".join(map(str, table)), value))
    return table[value]


def _mandel(voigt, what: str = "stiffness"):
    """A ph_sym4 of a Voigt matrix."""
    D = np.ascontiguousarray(voigt, dtype=float)
    if D.shape not in ((3, 3), (6, 6)):
        raise ValueError("%s must be 3 x 3 or 6 x 6, got %s" % (what, D.shape))
    return lib.ph_sym4_from_voigt(len(D), ffi.cast("double *", D.ctypes.data), True)


def _owned(pointer, ctype: str, free):
    """A pointer that the library's function frees when no one holds it."""
    return ffi.gc(pointer, lambda p: free(ffi.new(ctype + " **", p)))
