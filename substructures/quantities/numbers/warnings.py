"""Warnings about the values that a model is evaluated with, and about formulas that could not be judged."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

from substructures.array import Array
from substructures.documents import escape
from substructures.quantities.numbers.levels import dependent_left, ranges_left
from substructures.quantities.quantity import MODEL, TABLE
from substructures.quantities.sources import Sources, steps

Notice = Mapping[str, str]
#: warnings about a tree that its parameters decide, so that those given here are looked at instead
BY_VALUE = frozenset(("negative-mass", "negative-armature", "impossible-inertia"))
#: warnings about a tree that concern whoever evaluates it
TOLD = frozenset(("gravity-not-given", "friction-left-out"))


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
    effective = model.effective.union(others) if judge is None else model.effective.union(others, judge.limiting)
    notices += [_without_effect("parameter", name) for name in parameters if name not in effective]
    notices += [_without_effect("input", name) for name in inputs if name in model.inputs and name not in effective]
    if judge is not None and q is not None:
        notices += judge.left(model.positions, q, parameters, first)
        notices += judge.apart(model.positions, q, first)
    if model.reduced and q is not None and len(q):
        notices += ranges_left(model, q.min(axis=0), q.max(axis=0))
        notices += dependent_left(model, judge, q, parameters, first)
    return notices


def no_coordinates(dof: int) -> list[Notice]:
    """Of a tree in which nothing moves."""
    message = "the tree has no coordinates: nothing moves, and metric and forces are empty"
    return [] if dof else [{"pointer": "", "code": "no-coordinates", "message": message}]


def _without_effect(kind: str, name: str) -> Notice:
    message = f"no formula depends on the {kind} '{name}'"
    return {"pointer": f"/{kind}s/{escape(name)}", "code": "no-effect", "message": message}


def doubted(sources: Sources, quantities: Sequence[str]) -> list[str]:
    """Those of the quantities whose numbers come from formulas that are not judged. Raises as :func:`steps`."""
    marks: dict[str, frozenset[str]] = {}
    for source, program, names in steps(sources, quantities):
        if program is not None and program.not_judged:
            marks[source] = program.not_judged.intersection(names)
    found = {name: marks.get(TABLE[name].source, frozenset()) for name in quantities}
    # of several outputs of a program its own; numbers that are solved for come from all
    return [n for n, some in found.items() if some & set(TABLE[n].outputs) or (some and TABLE[n].source != MODEL)]
