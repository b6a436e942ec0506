"""The shape of a definition: what is left of it without words, and without values of parameters and inputs."""

from __future__ import annotations

from typing import Any

from substructures.part.definition import Definition

#: members of a definition that are words, or the name of the whole
WORDS = (
    "name",
    "title",
    "description",
    "tags",
    "license",
    "source",
    "poses",
    "left_out",
    "independent",
    "start",
    "ranges",
)


def shape_of(definition: Definition) -> dict[str, Any]:
    """The definition as plain data without words, defaults of inputs, and values of parameters, which have their SI
    units alone.

    Numbers that stand in bodies, joints and loads stay: formulas are made of them.
    """
    left = {name: x for name, x in definition.plain().items() if name not in WORDS}
    units = {name: parameter.si_unit for name, parameter in definition.parameters.items()}
    return without_descriptions(left) | {"parameters": units}


def without_descriptions(plain: dict[str, Any]) -> dict[str, Any]:
    """A definition or tree whose parameters and inputs have no descriptions, and inputs no defaults."""
    left = {"parameters": ("description",), "inputs": ("description", "default")}
    return plain | {
        kind: {name: {field: x for field, x in each.items() if field not in out} for name, each in plain[kind].items()}
        for kind, out in left.items()
        if kind in plain
    }
