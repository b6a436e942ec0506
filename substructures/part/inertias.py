"""Masses, inertia tensors and rotors of bodies in numbers, of one or of many sets of values, that none can have."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from substructures.array import Array
from substructures.part.definition import Body
from substructures.part.mass import number_of
from substructures.part.topology import CHAINS

#: an eigenvalue of Binet's tensor may be so much below zero, relative to the largest
ROUNDING = 1e-9
Indices = NDArray[np.intp]
#: m, h and Theta of a body for every set of values, (10, N); m = 0 where Theta is about the mass centre
Tensor = NDArray[Any]
ARMATURE = ("kg m^2", "kg")  #: units of the rotor inertia that is seen at a revolute and at a prismatic joint
PhysicsFault = tuple[str, str]  #: code, message
IMPOSSIBLE = "impossible-inertia"


def impossible_moments(eigenvalues: Array) -> str:
    """Of Binet's tensor about the mass centre (3,): J_i = sum of all - Theta_i."""
    shown = ", ".join(f"{x:.6g}" for x in np.sort(eigenvalues.sum() - eigenvalues))
    moments = f"no rigid body has the principal moments of inertia {shown} kg m^2 about its mass centre"
    return f"{moments} (triangle inequality)"


def more(count: int) -> str:
    """Beside the first of so many."""
    return f" (and in {count - 1} more)" if count > 1 else ""


def faults_of(body: Body, names: Mapping[str, Any], first: int) -> tuple[list[PhysicsFault], Tensor | None]:
    """Code and message of what a body cannot have, and its inertia where that is to be looked at, too: numbers alone
    were, when formulas were derived.
    """
    tensor = body.inertia
    inertia = [getattr(tensor, e) for e in ("xx", "yy", "zz", "xy", "xz", "yz")]
    armature, kinds, found = body.joint.armature, [s for s, _ in CHAINS[body.joint.type]], list[PhysicsFault]()
    rotors = armature if isinstance(armature, tuple) else [armature] * len(kinds)
    for given, s in dict.fromkeys((x, s) for x, s in zip(rotors, kinds, strict=True) if isinstance(x, str)):
        found += _negative("armature", number_of(given, names), ARMATURE[s], first)
    if not any(isinstance(x, str) for x in (body.mass, *body.com, *inertia)):
        return found, None
    # most are names of floats, which need not be read; other numbers become floats
    entries = (body.mass, *body.com, *inertia)
    known = [names.get(x) if type(x) is str else None for x in entries]
    numbers = [k if isinstance(k, float) else number_of(x, names) for k, x in zip(known, entries, strict=True)]
    if isinstance(body.mass, str):
        found += _negative("mass", numbers[0], "kg", first)
    if any(x is None for x in numbers):
        return found, None
    is_one = all(isinstance(x, float) for x in numbers)
    together = np.array(numbers if is_one else np.broadcast_arrays(*numbers)).reshape(10, -1)
    if tensor.about != "origin":
        together[0] = 0
    return found, together


def _negative(what: str, given: Any, unit: str, first: int) -> Iterator[PhysicsFault]:
    if given is None:
        return
    if isinstance(given, float) and given >= 0:
        return
    found = np.atleast_1d(given)
    bad = np.flatnonzero(~(found >= 0))
    if len(bad):
        is_what = "is negative" if found[bad[0]] < 0 else "is not a number"
        yield f"negative-{what}", f"the {what} {found[bad[0]]:g} {unit} {is_what}{_place(found, bad, first)}"


def _place(found: Array, bad: Indices, first: int) -> str:
    return f", in state {first + bad[0]}{more(len(bad))}" if len(found) > 1 else ""


def impossible(tensors: Sequence[Tensor], first: int) -> Iterator[list[PhysicsFault]]:
    """Of every tensor: about the mass centre it must have principal moments that obey the triangle inequality."""
    if not tensors:
        return
    # all bodies at all values together: one call for the eigenvalues of many small matrices
    m, x, y, z, xx, yy, zz, xy, xz, yz = np.concatenate(tensors, axis=1)
    # what overflows is told below
    with np.errstate(all="ignore"):
        # J = tr(Theta)/2 1 - Theta has no negative eigenvalue;   about another point J_C = J - m h h^T
        half, h = (xx + yy + zz) / 2, (x, y, z)
        J = np.array([[half - xx, -xy, -xz], [-xy, half - yy, -yz], [-xz, -yz, half - zz]])
        J = np.moveaxis(J - m * np.array([[a * b for b in h] for a in h]), -1, 0)
    finite = np.isfinite(J).all(axis=(1, 2))
    values = np.linalg.eigvalsh(np.where(finite[:, None, None], J, 0.0))
    is_bad = ~finite | (values[:, 0] < -ROUNDING * np.abs(values).max(axis=1))
    end = 0
    for tensor in tensors:
        start, end = end, end + tensor.shape[1]
        yield list(_told(values[start:end], np.flatnonzero(is_bad[start:end]), first))


def _told(eigenvalues: Array, bad: Indices, first: int) -> Iterator[PhysicsFault]:
    if len(bad):
        yield IMPOSSIBLE, f"{impossible_moments(eigenvalues[bad[0]])}{_place(eigenvalues, bad, first)}"
