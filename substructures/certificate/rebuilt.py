"""What a program has to be that was rebuilt with numbers or expressions in place of some symbols."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from flint import arb

from substructures.certificate.compare import compare
from substructures.certificate.linear import Ball
from substructures.certificate.numbers import Bindings
from substructures.certificate.outputs import Outputs
from substructures.certificate.states import states_between
from substructures.certificate.stored import Stored, operations_in_balls
from substructures.errors import VerificationFailed

#: the elements of J in the order of the symbols
TENSOR = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def require_same(result: Stored, source: Stored, bound: Mapping[str, Any], what: str) -> list[str]:
    """Raise VerificationFailed unless the outputs of ``result`` are those of ``source`` with the values ``bound`` for
    some of its symbols: numbers, or expressions in the others. Returns the outputs that cannot be judged.
    """

    def expected(values: Mapping[str, Ball]) -> Outputs:
        """The outputs of the source."""
        return outputs_of(source, Bindings(values, bound))

    kinds = {symbol.name: symbol.kind for symbol in source.symbols if symbol.name not in bound}
    try:
        return compare(result, kinds, expected, {}, states_between(result.operations, source.operations)).not_judged
    except VerificationFailed as error:
        raise VerificationFailed(f"{what}: {error}") from None


def outputs_of(source: Stored, values: Mapping[str, Ball]) -> Outputs:
    """All outputs of a program for values of its symbols."""
    found, result = operations_in_balls(source, values), Outputs()
    for name, output in source.outputs.items():
        entries = result.array(name, tuple(output.shape), output.symmetry)
        entries |= {tuple(i): found[entry] for i, entry in zip(output.index, output.entries, strict=True)}
    return result


def own_outputs(
    program: Stored, part: Stored, symbols: Mapping[int, Sequence[str]], values: Mapping[str, Ball]
) -> Outputs:
    """The outputs of a program of a part with nothing mounted on it: the ten inertia ``symbols`` of each carrier are
    what the outputs ``inertia.*`` of the part's certified program say.
    """
    unknown = {symbol.name: arb(0) for symbol in part.symbols if symbol.kind == "inertia"}
    found, zero = outputs_of(part, {**values, **unknown}), arb(0)
    own: dict[str, Ball] = {}
    for k, names in symbols.items():
        places = [("m", (k,)), *(("s", (k, i)) for i in range(3)), *(("J", (k, *pair)) for pair in TENSOR)]
        elements = [found[f"inertia.{name}"].entries.get(index, zero) for name, index in places]
        own |= dict(zip(names, elements, strict=True))
    return outputs_of(program, {**values, **own})
