"""Shapes of trees: one program for all trees that differ in the numbers of their parameters alone.

What may stand in the place of an instance is an Option: a part, where it is mounted, and the numbers of its parameters.
Two options have one key where all but these numbers and words are equal, and the same parameters have numbers; trees of
options with equal keys have one program, in which all parameters are symbols (notation.md, section 6).
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from substructures.array import Array
from substructures.compile import compile_program
from substructures.compile.kernel import NO_PLACES, Kernel, Places
from substructures.documents import write_json
from substructures.errors import InvalidDocument, InvalidInput
from substructures.expr.program import Program
from substructures.part.part import MAX_NODES, Part
from substructures.quantities.numbers.defaults import default_number
from substructures.quantities.numbers.evaluation import interpreted
from substructures.quantities.sources import Sources, of_parts
from substructures.tree.couple import couple_formulas
from substructures.tree.document import TreeSpec, read_instance
from substructures.tree.model import Model
from substructures.tree.numbers import places_of, without_numbers
from substructures.tree.units import differing_interfaces


@dataclass(frozen=True)
class Option:
    """What may stand in the place of an instance.

    ``fields``: of the instance in the tree document, with the parameters that are bound to expressions; ``values``: in
    SI by the name of the parameter in the definition, of those that have a number, and of its placement
    (:func:`substructures.tree.numbers.places_of`).
    """

    part: Part = field(repr=False)
    fields: Mapping[str, Any]
    values: Mapping[str, float]
    key: str


def option_of(part: Part, instance: Mapping[str, Any]) -> Option:
    """The option that an instance of a tree document is."""
    bound: dict[str, Any] = {}
    values = {
        name: default_number(each["value"]) for name, each in part.parameters.items() if each["value"] is not None
    }
    read = read_instance(instance)
    for name, given in read.parameters.items():
        try:
            values[name] = default_number(given)
        except InvalidInput:  # an expression in other parameters
            bound[name] = instance["parameters"][name]
            values.pop(name, None)
    fields = {**instance, "parameters": bound}
    placement, places = places_of(read)
    values |= {name: default_number(each.value) for name, each in places.items()}
    free = sorted(part.parameters.keys() - values.keys() - bound.keys())
    text = write_json([part.shape, read.at, placement.model_dump(), bound, free])
    return Option(part, fields, values, hashlib.sha256(text).hexdigest())


#: what gives numbers; a shape with so many rows is worth its machine code, which takes an arm 50 ms and is 2 to 3 us a
#: row quicker
INTERPRETER, KERNEL, WORTH_A_KERNEL = "interpreter", "kernel", 16_384


@dataclass(frozen=True)
class Shape:
    """A tree of options, coupled once. ``kernels``: compiled, by the outputs that were asked for; ``way``: whether
    machine code or the interpreter gives the numbers.
    """

    sources: Sources
    way: str = KERNEL
    kernels: dict[tuple[str, tuple[str, ...]], Kernel] = field(default_factory=dict, repr=False)

    @property
    def model(self) -> Model:
        """The model, without certificate."""
        return self.sources.model

    def evaluate(
        self, program: Program, values: Mapping[str, Any], names: list[str], states: int, places: Places = NO_PLACES, /
    ) -> dict[str, Array]:
        """The engine of evaluations: the interpreter, or a kernel of its own for every list of outputs."""
        if self.way == INTERPRETER:
            return interpreted(program, values, names, states, places)
        key = program.digest, tuple(names)
        if key not in self.kernels:
            self.kernels[key] = compile_program(program, names)
        return self.kernels[key].evaluate(values, threads=1, places=places)


def couple_shape(
    template: Mapping[str, Any],
    options: Sequence[Option],
    christoffel: bool,
    max_nodes: int = MAX_NODES,
    names: frozenset[str] | None = None,
) -> Shape:
    """The shape of a tree document with these options in the places of its instances, in their order.

    ``christoffel``: whether with the Christoffel symbols; ``names``: outputs that are enough. Raises InvalidDocument
    with pointers into the document, TooLarge.
    """
    spec = TreeSpec.read({**template, "instances": [dict(option.fields) for option in options]})
    parts = {instance.name: option.part for instance, option in zip(spec.instances, options, strict=True)}
    for told in differing_interfaces(spec, {name: part.definition for name, part in parts.items()}):
        raise InvalidDocument.at(told["pointer"], told["code"], told["message"])
    spec, _ = without_numbers(spec)
    model = couple_formulas(spec, parts, max_nodes, christoffel, names)
    return Shape(Sources(model, of_parts=of_parts(spec, parts, max_nodes)))


def values_of(options: Sequence[Option]) -> dict[str, float]:
    """The numbers of a tree of options, by the names of its parameters."""
    return {f"{each.fields['name']}.{name}": x for each in options for name, x in each.values.items()}
