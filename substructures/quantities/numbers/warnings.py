"""What is said of an evaluation: of its values, of formulas that could not be judged, and of doubtful results."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from substructures.array import Array
from substructures.documents import escape
from substructures.quantities.numbers.conditioning import Doubt, Look, closed_doubts, doubts, is_usable
from substructures.quantities.numbers.levels import dependent_left, ranges_left
from substructures.quantities.quantity import CONDITION, MODEL, REACTIONS, TABLE, Quantity
from substructures.quantities.sources import Sources, steps
from substructures.tree.model import no_coordinates

Notice = Mapping[str, str]
#: warnings about a tree that its parameters decide, so that those given here are looked at instead
BY_VALUE = frozenset(("negative-mass", "negative-armature", "impossible-inertia"))
#: warnings about a tree that concern whoever evaluates it
TOLD = frozenset(("gravity-not-given", "friction-left-out"))
_OPEN = (
    "the state does not meet the closures (also their velocities), or they lose rank there, or the metric is singular: "
    "take consistent states from loop states"
)
_ENDLESS = "the metric is singular to rounding, or not positive definite, or not finite: it has no condition number"
_NOT_FINITE = "the result is not finite: numbers overflow, or a formula divides by zero in this state"
_NO_MOTION = (
    "the accelerations of this state, which reactions are of, are not determined or not finite: ask for "
    "forward_dynamics to see why, or give accelerations 'qdd'"
)


def value_warnings(
    sources: Sources,
    parameters: Mapping[str, Any],
    inputs: Collection[str],
    q: Array | None,
    others: Collection[str] = (),
    first: int = 0,
) -> list[Notice]:
    """Impossible bodies with these ``parameters``, given in place of defaults; those and ``inputs`` without effect;
    limits left by ``q`` (N, n), if given, and relations that it does not fit; gravity that nobody gave.
    ``others``: parameters that other formulas than those of the model depend on; ``first``: what states are counted
    from.

    Pointers lead into the request, and for what is so without it into the document of the tree.
    """
    model, judge = sources.model, sources.judge
    tree: list[Notice] = list(model.certificate.get("warnings", ()))
    notices = [each for each in tree if each["code"] in TOLD] + no_coordinates(model.dof)
    if judge is None:  # what the tree was stored with
        notices += [each for each in tree if each["code"] in BY_VALUE]
    elif parameters:
        known = judge.at_defaults
        notices += [x if x in known else {**x, "pointer": "/parameters"} for x in judge.inertias(parameters, first)]
    else:
        notices += judge.at_defaults
    notices += _without_effect(sources, parameters, inputs, others)
    if judge is not None and q is not None:
        notices += judge.left(model.positions, q, parameters, first)
        notices += judge.apart(model.positions, q, first)
    if model.reduced and q is not None and len(q):
        notices += ranges_left(model, q.min(axis=0), q.max(axis=0))
        notices += dependent_left(model, judge, q, parameters, first)
    return notices


def _without_effect(
    sources: Sources, parameters: Collection[str], inputs: Collection[str], others: Collection[str]
) -> list[Notice]:
    """Parameters and inputs that nothing depends on."""
    model, judge = sources.model, sources.judge
    given = [("parameter", name) for name in parameters] + [("input", name) for name in inputs if name in model.inputs]
    if not given:
        return []
    effective = model.effective.union(others, () if judge is None else judge.limiting)
    return [
        {
            "pointer": f"/{kind}s/{escape(name)}",
            "code": "no-effect",
            "message": f"no formula depends on the {kind} '{name}'",
        }
        for kind, name in given
        if name not in effective
    ]


def doubted(sources: Sources, quantities: Sequence[str]) -> list[str]:
    """Those of the quantities whose numbers come from formulas that are not judged. Raises as :func:`steps`."""
    marks: dict[str, frozenset[str]] = {}
    for source, program, names in steps(sources, quantities):
        if program is not None and program.not_judged:
            marks[source] = program.not_judged.intersection(names)
    found = {name: marks.get(TABLE[name].source, frozenset()) for name in quantities}
    # of several outputs of a program its own; numbers that are solved for come from all
    return [n for n, some in found.items() if some & set(TABLE[n].outputs) or (some and TABLE[n].source != MODEL)]


def result_of(quantity: Quantity, found: Mapping[str, Array]) -> Any:
    """The arrays of a quantity; NaN where the metric could not be inverted."""
    result = quantity.of(found)
    if "pivots" in quantity.pivots and "pivots" in found:
        usable = is_usable(found["pivots"])
        if not usable.all():
            several = {name: _where(usable, x) for name, x in result.items()} if quantity.fields else None
            return _where(usable, result) if several is None else several
    return result


def _where(usable: NDArray[np.bool_], result: Array) -> Array:
    """NaN in all other states."""
    return np.where(usable.reshape(-1, *(1,) * (result.ndim - 1)), result, np.nan)


def told_of(
    names: Sequence[str],
    found: Mapping[str, Mapping[str, Array]],
    results: Mapping[str, Any],
    look: Look,
) -> dict[str, dict[int, Doubt]]:
    """What is to be said of accelerations and their derivatives, by quantity and state."""
    told = {}
    for name in names:
        outputs = found[TABLE[name].source]
        if not TABLE[name].pivots:
            continue
        if CONDITION in outputs:
            told[name] = closed_doubts(results[name], outputs[CONDITION], _OPEN)
        elif "pivots" in outputs:
            told[name] = doubts(_rows(results[name]), outputs["pivots"], look)
    return told


def _rows(result: Any) -> Array:
    """All numbers of a result in a row for each state."""
    each = list(result.values()) if isinstance(result, dict) else [result]
    return np.concatenate([x.reshape(len(x), prod(x.shape[1:])) for x in each], axis=1)


def advice(name: str, doubt: Doubt | None, is_beyond: bool, more: str = "") -> tuple[str, str]:
    """Code and message of a failure. ``is_beyond``: only in the precision wanted; ``more``: what else it may be."""
    if is_beyond:
        return "overflow", "the result is beyond 3.4e38, the largest number of single precision"
    message = {CONDITION: _ENDLESS, REACTIONS: _NO_MOTION}.get(name, _NOT_FINITE) if doubt is None else doubt.message
    return "not-finite" if doubt is None else doubt.code, f"{message}; {more}" if more else message


def state_warnings(
    results: Mapping[str, Any], told: Mapping[str, Mapping[int, Doubt]], single: bool
) -> Iterator[dict[str, Any]]:
    """A warning for every state with results that are doubtful."""
    for name, by_state in told.items():
        finite = np.asarray(np.isfinite(_rows(results[name])).all(axis=1))
        for state, doubt in by_state.items():
            if finite[state]:
                place = "/q" if single else f"/q/{state}"
                told_of = {"pointer": place, "code": doubt.code, "message": doubt.message}
                yield {**told_of, "state": state, "quantity": name}
