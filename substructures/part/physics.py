"""Masses, inertia tensors and rotors that no rigid body can have: faults for numbers, warnings for parameters."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from substructures.array import Array
from substructures.expr.construction.exact import nearest_float
from substructures.expr.interpret import interpret
from substructures.expr.program import Formulas, array, program
from substructures.loads.scope import Scope, no_names
from substructures.mechanics.linear3 import dense
from substructures.part.definition import Body, Definition
from substructures.part.mass import number_of
from substructures.part.mechanism import Mechanism
from substructures.part.topology import CHAINS

#: an eigenvalue of Binet's tensor may be so much below zero, relative to the largest
ROUNDING = 1e-9
Indices = NDArray[np.intp]
#: m, h and Theta of a body for every set of values, (10, N); m = 0 where Theta is about the mass centre
Tensor = NDArray[Any]
ARMATURE = ("kg m^2", "kg")  #: units of the rotor inertia that is seen at a revolute and at a prismatic joint
PhysicsFault = tuple[str, str]  #: code, message
IMPOSSIBLE = "impossible-inertia"


@dataclass(frozen=True)
class _Check:
    """A value of a body, with the place of its numbers in the definition."""

    body: int
    field: str
    unit: str
    formulas: Formulas


def physical_warnings(m: Mechanism) -> list[dict[str, str]]:
    """Warnings about default values. Raises InvalidDocument for impossible numbers."""
    checks = {f"x{k}": check for k, check in enumerate(_checks(m))}
    p = program(m.graph, {name: check.formulas for name, check in checks.items()}, m.scope.symbols)
    defaults = default_values(m)
    warnings = []
    for name, check in checks.items():
        needed = {p.symbols[p.operations[k][1]].name for k in p.reachable([name]) if p.operations[k][0] == "sym"}
        # without a default for each of its symbols a value says nothing about the body
        if not needed <= defaults.keys():
            continue
        problem = _problem(check, interpret(p, {s: defaults[s] for s in needed}, [name])[name])
        if problem is None:
            continue
        pointer = f"/bodies/{check.body}/{check.field}"
        text = f"body '{m.definition.bodies[check.body].name}': {problem[1]}"
        # what holds symbols may have other values in trees: only numbers alone are impossible for good
        if needed:
            warnings.append({"pointer": pointer, "code": problem[0], "message": f"{text} at the default values"})
        else:
            m.scope.fault(pointer, problem[0], text)
    m.scope.finish()
    return [*warnings, *_reversed_limits(m.definition, defaults)]


def _reversed_limits(definition: Definition, defaults: Mapping[str, float]) -> Iterator[dict[str, str]]:
    """Limits between which there is no value, at default values: stops would push from both sides at once."""
    for i, body in enumerate(definition.bodies):
        given = body.joint.limits or ()
        for pair in given if given and isinstance(given[0], tuple) else (given,) if given else ():
            low, high = (number_of(x, defaults) for x in pair)
            if low is not None and high is not None and low > high:
                text = f"body '{body.name}': the lower limit {low:g} is above the upper one {high:g}"
                yield {"pointer": f"/bodies/{i}/joint/limits", "code": "limits-reversed", "message": text}


def _checks(m: Mechanism) -> Iterator[_Check]:
    for i, (mass, J) in m.central.items():
        # J about the mass centre
        full = dense(J)
        yield _Check(i, "mass", "kg", array((), lambda mass=mass: mass))
        yield _Check(i, "inertia", "kg m^2", array((3, 3), lambda a, b, full=full: full[a][b]))
    for entry, law in zip(m.topology.joints, m.laws, strict=True):
        yield _Check(entry.body, "joint/armature", ARMATURE[entry.s], array((), lambda law=law: law.armature))


def default_values(m: Mechanism) -> dict[str, float]:
    """The parameters that have a default, as doubles."""
    return constants(m.scope, {name: p.value for name, p in m.definition.parameters.items()})


def constants(scope: Scope, given: Mapping[str, Any]) -> dict[str, float]:
    """Numbers and constant expressions as doubles; None is left out."""
    read = {n: scope.read(v, f"/parameters/{n}/value", no_names) for n, v in given.items() if v is not None}
    found = {n: nearest_float(v.value) for n, v in read.items() if v.is_number}
    others = {n: array((), lambda v=v: v) for n, v in read.items() if n not in found}
    numbers = interpret(program(scope.graph, others, {}), {}) if others else {}
    return found | {name: float(v) for name, v in numbers.items()}


def _problem(check: _Check, value: Array) -> PhysicsFault | None:
    if not np.isfinite(value).all():
        return "number-not-finite", "a value is beyond the range of floating point numbers"
    if check.field == "inertia":
        return _impossible_tensor(value)
    what = check.field.rpartition("/")[2]
    return (f"negative-{what}", f"the {what} {float(value):g} {check.unit} is negative") if value < 0 else None


def _impossible_tensor(binet: Array) -> PhysicsFault | None:
    """The Binet tensor about the mass centre has no negative eigenvalue (that is the triangle inequality)."""
    # J_i = (Theta_j + Theta_k - Theta_i) / 2 >= 0,   Theta_i = sum of all J - J_i
    eigenvalues = np.linalg.eigvalsh(binet)
    # 0 is right of thin discs and rods, and rounding may be below it; without any mass all of them are 0
    if eigenvalues[0] >= -ROUNDING * max(np.abs(eigenvalues).max(), 1e-300):
        return None
    return IMPOSSIBLE, _impossible_moments(np.asarray(eigenvalues, dtype=np.float64))


def _impossible_moments(eigenvalues: Array) -> str:
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
        yield IMPOSSIBLE, f"{_impossible_moments(eigenvalues[bad[0]])}{_place(eigenvalues, bad, first)}"
