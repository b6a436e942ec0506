"""Numbers of a tree that are values, taken out of its document: :mod:`.with_numbers` puts them in again."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from substructures.documents.fields import in_si
from substructures.expr.direct import steps_of
from substructures.part.definition import Parameter, Placement
from substructures.tree.document import Instance, TreeSpec

#: a number with more bits stays in the formulas: what is put in does not outgrow the numbers of a graph
MOST_BITS = 128
#: what the components of gravity are called where they are values; no instance can be called so
GRAVITY = "world.gravity"
#: m/s^2: gravity that belongs to the shape: nothing is to be put in where the usual tree is read
USUAL = frozenset((Fraction("9.81"), Fraction("9.80665")))


def without_numbers(spec: TreeSpec) -> tuple[TreeSpec, dict[str, Fraction]]:
    """The tree in which parameters that are bound to numbers are free and numbers of placements are parameters of its
    own, and these numbers in SI by name: ``instance.parameter``, ``instance.position.x``, ``instance.rpy.x``, and
    ``world.gravity.x`` of gravity that is not the usual one.

    >>> p = {"name": "p", "substructure": "x", "parameters": {"l": 2, "m": "m0", "k": 0}}
    >>> free, numbers = without_numbers(TreeSpec.read({"name": "t", "instances": [p]}))
    >>> free.instances[0].parameters, numbers
    ({'m': 'm0', 'k': 0}, {'p.l': Fraction(2, 1)})
    """
    instances, numbers, parameters = [], dict[str, Fraction](), dict(spec.parameters)
    for each in spec.instances:
        own = {name: x for name, given in each.parameters.items() if (x := _value(given)) is not None}
        left = {name: given for name, given in each.parameters.items() if name not in own}
        placement, places = places_of(each)
        parameters |= {f"{each.name}.{name}": place for name, place in places.items()}
        own |= {name: x for name, place in places.items() if (x := _value(place.value)) is not None}
        numbers |= {f"{each.name}.{name}": x for name, x in own.items()}
        instances.append(each.model_copy(update={"parameters": left, "placement": placement}) if own else each)
    gravity, pulls = _gravity_of(spec)
    numbers |= pulls
    parameters |= {name: Parameter(value=x, unit="m/s^2") for name, x in pulls.items()}
    made = {"instances": tuple(instances), "parameters": parameters, "gravity": gravity}
    return (spec.model_copy(update=made) if numbers else spec), numbers


def _gravity_of(spec: TreeSpec) -> tuple[tuple[Any, ...], dict[str, Fraction]]:
    """Gravity with names in the places of its numbers, and these numbers; as it is where all are usual."""
    given = {f"{GRAVITY}.{axis}": x for axis, x in zip("xyz", spec.gravity, strict=True)}
    numbers = {name: number for name, x in given.items() if (number := _value(x)) is not None}
    if {abs(x) for x in numbers.values()} <= USUAL:
        return spec.gravity, {}
    return tuple(name if name in numbers else x for name, x in given.items()), numbers


def places_of(instance: Instance) -> tuple[Placement, dict[str, Parameter]]:
    """The placement of an instance with names in the places of its numbers, and what these names stand for, by the rest
    of the name: ``position.x``. No name of a document has two dots.
    """
    found: dict[str, Parameter] = {}
    vectors: dict[str, tuple[Any, ...]] = {}
    for vector, unit in (("position", "m"), ("rpy", "rad")):
        given = {f"{vector}.{axis}": x for axis, x in zip("xyz", getattr(instance.placement, vector), strict=True)}
        own = {name: Parameter(value=in_si(x), unit=unit) for name, x in given.items() if _value(x) is not None}
        vectors[vector] = tuple(f"{instance.name}.{name}" if name in own else x for name, x in given.items())
        found |= own
    return (instance.placement.model_copy(update=vectors) if found else instance.placement), found


def _value(given: Any) -> Fraction | None:
    """A number that is a value, also one in quotes; None of expressions and of what belongs to the shape."""
    try:
        number, *rest = steps_of(in_si(given))
    except ValueError:  # is told where it is read
        return None
    if number.op != "number" or any(step.op != "neg" for step in rest):
        return None
    found = Fraction(number.value) * (-1) ** len(rest)  # type: ignore[arg-type]  # as its op says
    if abs(found) in (0, 1):
        return None
    return found if max(found.numerator.bit_length(), found.denominator.bit_length()) <= MOST_BITS else None
