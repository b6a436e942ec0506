"""Masses, inertia tensors and rotors that no rigid body can have: faults for numbers, warnings for parameters."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.expr.construction.exact import nearest_float
from substructures.expr.interpret import interpret
from substructures.expr.program import Formulas, array, program
from substructures.loads.scope import Scope, no_names
from substructures.mechanics.linear3 import dense
from substructures.part.definition import Definition
from substructures.part.inertias import ARMATURE, IMPOSSIBLE, ROUNDING, PhysicsFault, impossible_moments
from substructures.part.mass import number_of
from substructures.part.mechanism import Mechanism


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
    return IMPOSSIBLE, impossible_moments(np.asarray(eigenvalues, dtype=np.float64))
