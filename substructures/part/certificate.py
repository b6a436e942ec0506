"""What was checked when formulas were stored: agreement with the direct form, physics."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from time import perf_counter
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.errors import SubstructuresError
from substructures.expr.interpret import interpret
from substructures.expr.operations import Symbol
from substructures.expr.program import Program, array, program
from substructures.mechanics.direct_form import NumericJoint, direct_form
from substructures.mechanics.kinematics import links
from substructures.mechanics.linear3 import SYMMETRIC_INDEX
from substructures.part.inertia_symbols import inertia_names
from substructures.part.mechanism import Mechanism
from substructures.part.physics import default_values, physical_warnings

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
    certificate: dict[str, Any] = {"states": STATES, "tolerance": TOLERANCE, "warnings": warnings}
    if m.joints:
        certificate["positive_definite"] = _positive_definite(m, result, values)
        certificate["direct_form"] = finite_comparison(
            lambda some: _comparison(m, result, some), values, default_values(m)
        )
    certificate["seconds"] = {"derive": round(derive_seconds, 6), "verify": round(perf_counter() - start, 6)}
    return certificate


def _comparison(m: Mechanism, result: Program, values: Mapping[str, Array]) -> dict[str, Any]:
    joints = _numeric_joints(m, values)
    form = direct_form(joints, np.zeros((STATES, 3)))
    computed = interpret(result, values, ["metric", "christoffel", "armature"])
    # the direct form knows bodies only: g_cc += armature_c
    form.metric[...] += computed["armature"][..., None] * np.eye(len(joints))
    return compare(computed, {"metric": form.metric, "christoffel": form.christoffel})


def finite_comparison(
    comparison: Callable[[Mapping[str, Array]], dict[str, Any]],
    values: Mapping[str, Array],
    defaults: Mapping[str, float],
) -> dict[str, Any]:
    """The comparison at random values; where these are outside of a formula's domain, at the parameters' defaults."""
    result = comparison(values)
    if None in result["max_relative_error"].values():
        result = comparison({**values, **{name: np.full(STATES, x) for name, x in defaults.items()}})
    return result


def compare(computed: Mapping[str, Array], expected: Mapping[str, Array]) -> dict[str, Any]:
    """Largest deviation of each quantity relative to the largest entry of all; None where something is not finite.

    Raises VerificationFailed.
    """
    largest = [float(np.abs(x[np.isfinite(x)]).max(initial=0.0)) for x in expected.values()]
    # |computed - expected| / largest entry of all: entries that cancel to zero have no relative error of their own
    scale = max(largest) or 1.0
    errors: dict[str, float | None] = {}
    for name, value in expected.items():
        error = float(np.abs(computed[name] - value).max(initial=0.0)) / scale
        errors[name] = error if np.isfinite(error) else None
        if np.isfinite(error) and error > TOLERANCE:
            raise VerificationFailed(f"{name} deviates from the direct form by {error:.3g}")
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
    name = m.topology.body_of
    return [
        NumericJoint(j.parent, j.s, x["E"][:, c], x["Z"][:, c], x["tau"][:, c], *_inertia(values, name.get(c)))
        for c, j in enumerate(m.joints)
    ]


def _inertia(values: Mapping[str, Array], body: str | None) -> tuple[Array, Array, Array]:
    if body is None:
        return np.zeros(STATES), np.zeros((STATES, 3)), np.zeros((STATES, 3, 3))
    J = [values[f"{body}.J{e}"] for e in ("xx", "yy", "zz", "xy", "xz", "yz")]
    # J_ij from its six entries, about the body frame origin
    full = np.stack([np.stack([J[SYMMETRIC_INDEX[i][j]] for j in range(3)], -1) for i in range(3)], -2)
    return values[f"{body}.m"], np.stack([values[f"{body}.s{e}"] for e in "xyz"], -1), full


def _positive_definite(m: Mechanism, result: Program, values: Mapping[str, Array]) -> bool | None:
    """Whether the own metric is positive definite at the default values and random states; None without defaults."""
    defaults = default_values(m)
    if any(p.value is None for p in m.definition.parameters.values()):
        return None
    numbers: dict[str, Any] = {**values, **defaults}
    own = interpret(result, numbers, ["inertia.m", "inertia.s", "inertia.J"])
    for k, body in m.topology.body_of.items():
        symbols = [symbol for symbol, _ in inertia_names(body)]
        tensor = [own["inertia.J"][..., k, i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
        first = [own["inertia.m"][..., k], *(own["inertia.s"][..., k, i] for i in range(3))]
        numbers |= dict(zip(symbols, [*first, *tensor], strict=True))
    # with the own values for the inertia symbols
    metric = interpret(result, numbers, ["metric"])["metric"]
    if not np.isfinite(metric).all():
        return None
    # lambda_min > 0 up to rounding: q'^T g q' > 0 for all q' that are not zero
    eigenvalues = np.linalg.eigvalsh(metric)
    return bool((eigenvalues[..., 0] > 1e-13 * eigenvalues[..., -1]).all())


def told_agreement(certificate: Mapping[str, Any]) -> str:
    """The largest error of a certificate, in words."""
    errors = certificate.get("direct_form", {}).get("max_relative_error", {})
    return f"agrees with the direct form to {max(errors.values(), default=0):.0e}" if errors else "not verified"
