"""What was checked when formulas were stored: agreement with the direct form, physics."""

from __future__ import annotations

from collections.abc import Mapping
from time import perf_counter
from typing import Any

import numpy as np

from substructures.direct import Array, NumericJoint, direct_form
from substructures.errors import SubstructuresError
from substructures.expr.interpret import interpret
from substructures.expr.program import Formulas, Program, Symbol, array, program
from substructures.mechanics.joints import links
from substructures.mechanics.linear3 import SYMMETRIC_INDEX, dense
from substructures.mechanism import Mechanism
from substructures.scope import no_names

STATES = 4
TOLERANCE = 1e-9


class VerificationFailed(SubstructuresError):
    """Derived formulas disagree with the direct form: a defect of this package. Nothing is stored."""


def random_values(
    symbols: Mapping[str, Symbol] | tuple[Symbol, ...], n: int = STATES, seed: int = 0
) -> dict[str, Array]:
    """Random values for symbols: everything of the order of one, parameters and masses positive."""
    rng = np.random.default_rng(seed)
    some = symbols.values() if isinstance(symbols, Mapping) else symbols
    positive = {"parameter", "inertia"}
    return {
        s.name: rng.uniform(0.5, 1.5, n) if s.kind in positive else rng.uniform(-2.0, 2.0, n)
        for s in sorted(some, key=lambda s: s.name)
    }


def certify_part(m: Mechanism, result: Program, derive_seconds: float) -> dict[str, Any]:
    """Verify the own metric and Christoffel symbols; check masses and inertia tensors.

    Raises InvalidDocument for numbers that no rigid body can have, VerificationFailed for a wrong formula.
    """
    start = perf_counter()
    warnings = physical_warnings(m)
    values = random_values(m.scope.symbols)
    joints = _numeric_joints(m, values)
    certificate: dict[str, Any] = {"states": STATES, "tolerance": TOLERANCE, "warnings": warnings}
    if joints:
        form = direct_form(joints, np.zeros((STATES, 3)))
        computed = interpret(result, values, ["metric", "christoffel", "armature"])
        form.metric[...] += computed["armature"][..., None] * np.eye(len(joints))
        expected = {"metric": form.metric, "christoffel": form.christoffel}
        certificate["direct_form"] = compare(computed, expected)
    certificate["seconds"] = {"derive": round(derive_seconds, 6), "verify": round(perf_counter() - start, 6)}
    return certificate


def compare(computed: Mapping[str, Array], expected: Mapping[str, Array]) -> dict[str, Any]:
    """Largest deviation of each quantity, relative to its largest entry. Raises VerificationFailed."""
    errors: dict[str, Any] = {}
    for name, value in expected.items():
        finite = np.isfinite(value) & np.isfinite(computed[name])
        if not finite.all():
            errors[name] = None  # a formula is singular at the random values; nothing can be said
            continue
        scale = max(float(np.abs(value).max(initial=0.0)), 1.0)
        errors[name] = float(np.abs(computed[name] - value).max(initial=0.0)) / scale
        if errors[name] > TOLERANCE:
            raise VerificationFailed(f"{name} deviates from the direct form by {errors[name]:.3g}")
    return {"max_relative_error": errors}


def _numeric_joints(m: Mechanism, values: Mapping[str, Array]) -> list[NumericJoint]:
    """The joint rows, evaluated; the inertia symbols stand for the bodies."""
    chain, n = links(m.joints), len(m.joints)
    E = [link.rotation.matrix() for link in chain]
    rows = program(
        m.graph,
        {
            "E": array((n, 3, 3), lambda c, i, j: E[c][i][j]),
            "Z": array((n, 3), lambda c, i: chain[c].Z[i]),
            "tau": array((n,), lambda c: m.joints[c].tau),
        },
        m.scope.symbols,
    )
    x = interpret(rows, values)
    name = {carrier: body for body, carrier in reversed(m.skeleton.carrier.items())}
    return [
        NumericJoint(j.parent, j.s, x["E"][:, c], x["Z"][:, c], x["tau"][:, c], *_inertia(values, name.get(c)))
        for c, j in enumerate(m.joints)
    ]


def _inertia(values: Mapping[str, Array], body: str | None) -> tuple[Array, Array, Array]:
    if body is None:
        return np.zeros(STATES), np.zeros((STATES, 3)), np.zeros((STATES, 3, 3))
    J = [values[f"{body}.J{e}"] for e in ("xx", "yy", "zz", "xy", "xz", "yz")]
    full = np.stack([np.stack([J[SYMMETRIC_INDEX[i][j]] for j in range(3)], -1) for i in range(3)], -2)
    return values[f"{body}.m"], np.stack([values[f"{body}.s{e}"] for e in "xyz"], -1), full


def physical_warnings(m: Mechanism) -> list[dict[str, str]]:
    """Negative masses and impossible inertia tensors: faults for numbers, warnings for default values."""
    outputs: dict[str, Formulas] = {}
    for i, (mass, J) in m.central.items():
        full = dense(J)
        outputs[f"mass.{i}"] = array((), lambda mass=mass: mass)
        outputs[f"J.{i}"] = array((3, 3), lambda a, b, full=full: full[a][b])
    p = program(m.graph, outputs, m.scope.symbols)
    defaults = _defaults(m)
    warnings = []
    for name in outputs:
        needed = {p.symbols[p.operations[k][1]].name for k in p.reachable([name]) if p.operations[k][0] == "sym"}
        if not needed <= defaults.keys():
            continue
        problem = _impossible(name, interpret(p, {s: defaults[s] for s in needed}, [name])[name])
        if problem is None:
            continue
        i = int(name.split(".")[1])
        pointer = f"/bodies/{i}/" + ("mass" if name.startswith("mass") else "inertia")
        text = f"body '{m.definition.bodies[i].name}': {problem[1]}"
        if needed:
            warnings.append({"pointer": pointer, "code": problem[0], "message": f"{text} at the default values"})
        else:
            m.scope.fault(pointer, problem[0], text)
    m.scope.finish()
    return warnings


def _defaults(m: Mechanism) -> dict[str, float]:
    values = {
        name: m.scope.read(p.value, f"/parameters/{name}/value", no_names)
        for name, p in m.definition.parameters.items()
        if p.value is not None
    }
    numbers = interpret(program(m.graph, {n: array((), lambda v=v: v) for n, v in values.items()}, {}), {})
    return {name: float(v) for name, v in numbers.items()}


def _impossible(name: str, value: Array) -> tuple[str, str] | None:
    """(code, message) when no rigid body has this mass, or this Binet tensor about its mass centre."""
    if name.startswith("mass"):
        return ("negative-mass", f"the mass {float(value):g} kg is negative") if value < 0 else None
    eigenvalues = np.linalg.eigvalsh(value)
    if eigenvalues[0] >= -1e-9 * max(np.abs(eigenvalues).max(), 1e-300):
        return None
    moments = np.sort(eigenvalues.sum() - eigenvalues)
    shown = ", ".join(f"{x:.6g}" for x in moments)
    return "impossible-inertia", (
        f"no rigid body has the principal moments of inertia {shown} kg m^2 about its mass centre (triangle inequality)"
    )
