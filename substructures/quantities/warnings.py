"""Warnings about the values that a model is evaluated with."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from substructures.array import Array
from substructures.documents import escape
from substructures.quantities.table import Sources

Notice = Mapping[str, str]
#: warnings about a tree that its parameters decide, so that those given here are looked at instead
BY_VALUE = frozenset(("negative-mass", "negative-armature", "impossible-inertia"))
#: warnings about a tree that concern whoever evaluates it
TOLD = frozenset(("gravity-not-given",))


def value_warnings(
    sources: Sources, values: Mapping[str, Any], given: Collection[str], q: Array, t: Array | None = None
) -> list[Notice]:
    """Impossible bodies with these ``values`` of parameters, those ``given`` without effect, limits left by ``q``
    (N, n), which are a motion if there are times ``t`` (N,); and gravity that nobody gave.
    """
    model, judge = sources.model, sources.judge
    tree: list[Notice] = list(model.certificate.get("warnings", ()))
    notices = [each for each in tree if each["code"] in TOLD]
    parameters = {name: values[name] for name in given}
    if judge is None:  # what the tree was stored with
        notices += [each for each in tree if each["code"] in BY_VALUE]
    elif parameters:
        notices += judge.inertias(parameters)
    else:
        notices += judge.at_defaults
    limiting = frozenset[str]() if judge is None else judge.limiting
    notices += [_without_effect(name) for name in given if name not in model.effective and name not in limiting]
    if judge is not None:
        notices += judge.left(model.coordinates, q, parameters, t)
    return notices


def _without_effect(name: str) -> Notice:
    message = f"no formula depends on the parameter '{name}'"
    return {"pointer": f"/parameters/{escape(name)}", "code": "no-effect", "message": message}
