"""Parts and models that many tests ask for, derived and coupled once in a process; they are frozen."""

from __future__ import annotations

import json
from typing import Any

from substructures import Definition, Model, Part, TreeSpec, couple, derive

Plain = dict[str, Any]

_parts: dict[str, Part] = {}
_models: dict[tuple[str, ...], Model] = {}


def _text(data: Plain) -> str:
    """Tells data apart that are read differently: a decimal number is no text."""
    return json.dumps(data, default=repr)


def derived_once(definition: Plain) -> Part:
    """The part of a definition."""
    text = _text(definition)
    if text not in _parts:
        _parts[text] = derive(Definition.read(definition))
    return _parts[text]


def coupled_once(tree: Plain, definitions: Plain) -> Model:
    """The model of a tree. ``definitions``: by the reference that its instances give."""
    key = _text(tree), _text(definitions)
    if key not in _models:
        parts = {i["name"]: derived_once(definitions[i["substructure"]]) for i in tree["instances"]}
        _models[key] = couple(TreeSpec.read(tree), parts)
    return _models[key]
