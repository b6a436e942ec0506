"""What was checked when formulas of a part were stored: every output against the definition's own text, and physics."""

from __future__ import annotations

from time import perf_counter
from typing import Any

import numpy as np
from flint import arb

from substructures.certificate.agreement import HOW, told
from substructures.certificate.compare import compare
from substructures.certificate.numbers import Plain
from substructures.certificate.part_outputs import metric_alone, part_outputs, part_symbols
from substructures.certificate.states import draws, states_needed
from substructures.certificate.written import defaults_of, plain
from substructures.expr.program import Program
from substructures.mechanics.accelerations import condition
from substructures.part.mechanism import Mechanism
from substructures.part.physics import physical_warnings


def certify_part(m: Mechanism, result: Program, derive_seconds: float) -> dict[str, Any]:
    """Compare every output with the definition's text (certificate.md); check masses and inertia tensors.

    Raises InvalidDocument for numbers that no rigid body can have, VerificationFailed for a wrong formula.
    """
    start = perf_counter()
    warnings = physical_warnings(m)
    definition = plain(m.definition)
    states = states_needed(result.operations, [definition])
    certificate: dict[str, Any] = {**HOW, "states": states, "warnings": warnings}
    if m.joints:
        certificate["positive_definite"] = _positive_definite(definition)
    kinds = part_symbols(definition)
    certificate["direct_form"] = told(
        compare(
            result,
            kinds,
            lambda values: part_outputs(definition, values, result.outputs),
            defaults_of(definition),
            states,
        )
    )
    certificate["seconds"] = {"derive": round(derive_seconds, 6), "verify": round(perf_counter() - start, 6)}
    return certificate


def _positive_definite(definition: Plain) -> bool | None:
    """Whether the own metric is positive definite at the default values and a random state; None without defaults."""
    defaults = defaults_of(definition)
    if len(defaults) < len(definition.get("parameters", ())):
        return None
    states = next(draws(part_symbols(definition), defaults, 1))
    balls = [metric_alone(definition, {**{n: arb(x) for n, x in s.items()}, **defaults}) for s in states]
    metric = np.array([[[float(x) for x in row] for row in g] for g in balls])
    if not np.isfinite(metric).all():
        return None
    # q'^T g q' > 0 for all q' that are not zero, up to rounding, whatever the units of coordinates
    return bool((condition(metric) < 1e13).all())
