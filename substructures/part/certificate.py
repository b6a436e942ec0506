"""What was checked when formulas of a part were stored: every output against the definition's own text, and physics."""

from __future__ import annotations

from collections.abc import Mapping
from decimal import Decimal
from time import perf_counter
from typing import Any

import numpy as np
from flint import arb

from substructures.certificate.compare import TOLERANCE, Compared, compare
from substructures.certificate.numbers import Plain
from substructures.certificate.part_outputs import metric_alone, part_outputs, part_symbols
from substructures.certificate.states import draws, states_needed
from substructures.documents import Document
from substructures.documents.units import read_unit
from substructures.errors import VerificationFailed, listed
from substructures.expr.direct import ball
from substructures.expr.program import Program
from substructures.part.mechanism import Mechanism
from substructures.part.physics import physical_warnings

#: how formulas are compared, in every certificate; those of older versions say less
HOW = {"compared_with": "documents", "tolerance": TOLERANCE}


def plain(document: Document) -> Plain:
    """The document as it was written, with its numbers in SI, which is all that a certificate knows of it."""
    return _declaring(document.model_dump(exclude_defaults=True, by_alias=True))


def _declaring(document: Plain) -> Plain:
    """A definition or tree: units of its parameters are those of their symbols, not of numbers."""
    apart = ("parameters", "inputs", "start", "ranges", "poses", "instances")
    found = {name: _in_si(value) for name, value in document.items() if name not in apart}
    declared = {kind: document[kind] for kind in ("parameters", "inputs") if kind in document}
    for kind, some in declared.items():
        found[kind] = {name: {**given, "value": _in_si(given.get("value"))} for name, given in some.items()}
    # what is by names of the user: two of them may be called "value" and "unit"
    found |= {field: _named(document[field]) for field in ("start", "ranges") if field in document}
    if "poses" in document:
        found["poses"] = {pose: _named(given) for pose, given in document["poses"].items()}
    if "instances" in document:
        found["instances"] = [_instance(given) for given in document["instances"]]
    return found


def _named(given: Plain) -> Plain:
    return {name: _in_si(value) for name, value in given.items()}


def _instance(given: Plain) -> Plain:
    inline = {"definition": _declaring(given["definition"])} if given.get("definition") else {}
    bound = {"parameters": _named(given["parameters"])} if "parameters" in given else {}
    return {name: _in_si(value) for name, value in given.items() if name not in ("definition", *bound)} | bound | inline


def _in_si(given: Any) -> Any:
    """What was given, with numbers in place of values with units."""
    if isinstance(given, Mapping):
        if set(given) == {"value", "unit"}:
            return read_unit(given["unit"]).in_si(given["value"])
        return {name: _in_si(value) for name, value in given.items()}
    return [_in_si(value) for value in given] if isinstance(given, (list, tuple)) else given


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


def told(found: Compared) -> dict[str, Any]:
    """What a comparison says in a certificate: ``potential_left_out`` where there is anything to say."""
    left_out = {"potential_left_out": found.left_out} if found.left_out else {}
    return {"max_relative_error": found.errors, **left_out}


def not_judged(certificate: Mapping[str, Any]) -> list[str]:
    """The outputs of which a certificate cannot tell whether they are right."""
    errors: Mapping[str, Any] = certificate.get("direct_form", {}).get("max_relative_error", {})
    return [name for name, error in errors.items() if error is None]


def require_no_less(before: Mapping[str, Any], now: Mapping[str, Any]) -> None:
    """Raise VerificationFailed where a certificate made anew vouches for less than the one that is stored."""
    given = {name: before.get(name) for name in HOW}
    # what was compared otherwise vouches for nothing that could be lost; numbers of documents are decimals
    if {name: float(x) if isinstance(x, Decimal) else x for name, x in given.items()} != HOW:
        return
    was, found = before.get("direct_form", {}), now["direct_form"]
    errors = was.get("max_relative_error", {})
    lost = [n for n, error in found["max_relative_error"].items() if error is None and errors.get(n) is not None]
    if lost:
        raise VerificationFailed(f"{listed(lost)} had values that could be compared with the documents, and has none")
    left_out = set(found.get("potential_left_out", ())) - set(was.get("potential_left_out", ()))
    if left_out:
        raise VerificationFailed(f"the potential of the forces on {listed(sorted(left_out))} is left out")


def defaults_of(definition: Plain, prefix: str = "") -> dict[str, Any]:
    """The default values of parameters as balls; ``prefix``: of their names."""
    given = {name: parameter.get("value") for name, parameter in definition.get("parameters", {}).items()}
    return {f"{prefix}{name}": ball(value, precision=1100) for name, value in given.items() if value is not None}


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
    # lambda_min > 0 up to rounding: q'^T g q' > 0 for all q' that are not zero
    eigenvalues = np.linalg.eigvalsh(metric)
    return bool((eigenvalues[..., 0] > 1e-13 * eigenvalues[..., -1]).all())


def told_agreement(certificate: Mapping[str, Any]) -> str:
    """The largest error of a certificate, in words."""
    errors = certificate.get("direct_form", {}).get("max_relative_error", {})
    known = [error for error in errors.values() if error is not None]
    return f"agrees with the direct form to {max(known):.0e}" if known else "not verified"
