"""At which of the positions that closures allow a program of the reduced level is compared with the documents.

On the branch of a loop det d phi / dz may change its sign, as that of parallelograms does where they are flat. So at
each state a program has to be what the documents say of one of the positions there; and at the start of the definition,
with the default values of its parameters, of the position that is nearest to it. What is analytic has one branch.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import islice, product
from typing import Any

from flint import arb, ctx

from substructures.certificate.given.loops import NOWHERE, WAY
from substructures.certificate.linear import Ball
from substructures.certificate.numbers import Numbers, Plain
from substructures.certificate.outputs import Outputs
from substructures.certificate.states import EXACT, draws
from substructures.certificate.stored import Stored, operations_in_balls
from substructures.errors import VerificationFailed

#: most combinations of sides
MOST = 64
#: what tells a position
PLACES = ("position", "rotation", "metric")

#: outputs out of the document of a tree, at values of all symbols
Make = Callable[[Plain, Mapping[str, Any]], Outputs]


def on_a_side(tree: Plain, definitions: Mapping[str, Plain], program: Stored, make: Make) -> Callable[[Any], Outputs]:
    """What ``make`` gives for the position that the program has at a state; for the first one where it has none, but
    nothing outside of stated ranges, where Newton's method may go anywhere.
    """
    if not tree.get("reduced"):
        return lambda values: make(tree, values)

    def expected(values: Mapping[str, Ball]) -> Outputs:
        """At one state."""
        stored, first = operations_in_balls(program, values), None
        is_stated = _is_stated(tree, definitions, values)
        for sides in _sides(tree, definitions) if is_stated or _is_finite(program, stored) else ():
            outputs = make({**tree, "sides": sides}, values)
            if _agrees(program, stored, outputs, outputs.keys()) or not _is_closed(outputs):
                return outputs
            first = first or outputs
        if not is_stated:
            return make({**tree, "sides": NOWHERE}, values)
        return first or Outputs()

    return expected


def _sides(tree: Plain, definitions: Mapping[str, Plain]) -> Iterator[tuple[int, ...] | str]:
    yield from _ways(tree, definitions)
    count = sum(len(definitions[name]["closures"]) for name in tree["reduced"])
    yield from islice(product((1, -1), repeat=count), MOST)


def _ways(tree: Plain, definitions: Mapping[str, Plain]) -> tuple[str, ...]:
    """Of what may be found by steps from the start."""
    return (WAY,) if any(definitions[name].get("ranges") for name in tree["reduced"]) else ()


def _is_finite(program: Stored, stored: list[Ball]) -> bool:
    """Whether all elements of a program have values, as they do where it has a position."""
    return all(stored[entry].is_finite() for output in program.outputs.values() for entry in output.entries)


def _is_stated(tree: Plain, definitions: Mapping[str, Plain], values: Mapping[str, Ball]) -> bool:
    """Whether the ranges of definitions hold, which are those of the default values of their parameters."""
    number = Numbers({}).read
    bound = {f"{i['name']}.{p}" for i in tree.get("instances", ()) for p in i.get("parameters", {})}
    for name in tree["reduced"]:
        definition = definitions[name]
        for q, (low, high) in definition.get("ranges", {}).items():
            if not float(number(low)) <= float(values.get(f"{name}.{q}", number(low))) <= float(number(high)):
                return False
        given = {f"{name}.{p}": x.get("value") for p, x in definition.get("parameters", {}).items()}
        is_default = (p not in bound and (x is None or number(x).overlaps(values[p])) for p, x in given.items())
        if definition.get("ranges") and not all(is_default):
            return False
    return True


def _is_closed(outputs: Outputs) -> bool:
    """Whether there is a position: everything has a value, but for potentials that are not known."""
    return all(x.is_finite() for values in outputs.values() if values.shape for x in values.entries.values())


def _agrees(program: Stored, stored: list[Ball], outputs: Outputs, names: Any) -> bool:
    """Whether all elements may be the same ones."""
    for name in (name for name in names if name in program.outputs and not outputs[name].along):
        output, values = program.outputs[name], outputs[name]
        for index, entry in zip(output.index, output.entries, strict=True):
            x = values.entries.get(tuple(index), arb(0))
            # what is not finite overlaps everything
            is_same = x.is_finite() and stored[entry].is_finite() and stored[entry].overlaps(x)
            if tuple(index) not in values.others and not is_same:
                return False
    return True


def starts_of(tree: Plain, definitions: Mapping[str, Plain]) -> dict[str, Any]:
    """Where the independent coordinates of reduced instances start, by name."""
    with ctx.workprec(EXACT):
        return {
            f"{name}.{q}": Numbers({}).read(definitions[name].get("start", {}).get(q, 0))
            for name in tree.get("reduced", ())
            for q in definitions[name]["independent"]
        }


def require_start(
    tree: Plain, definitions: Mapping[str, Plain], program: Stored, make: Make, kinds: Mapping[str, str]
) -> None:
    """Raises VerificationFailed unless the program is on the branch of the start."""
    if not tree.get("reduced"):
        return
    (state,) = next(draws(kinds, {}, 1))
    with ctx.workprec(128):
        values = {name: arb(x) for name, x in state.items()}
        for name in tree["reduced"]:
            given = {f"{name}.{p}": x.get("value") for p, x in definitions[name].get("parameters", {}).items()}
            values |= {p: Numbers({}).read(1 if x is None else x) for p, x in given.items() if p in values}
        values |= {q: x for q, x in starts_of(tree, definitions).items() if q in values}
        stored = operations_in_balls(program, values)
        # the nearest position, or that which Newton's method finds from the start
        found = [make({**tree, "sides": sides}, values) for sides in ((), *_ways(tree, definitions))]
        known = all(x.is_finite() for name in PLACES if name in found[0] for x in found[0][name].entries.values())
        if known and not any(_agrees(program, stored, outputs, PLACES) for outputs in found):
            raise VerificationFailed("the loops are not on the branch of the start of their definitions")
