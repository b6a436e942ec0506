"""Programs that follow from a model compared with what they have to be (certificate.md, section 4)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import lru_cache
from typing import Any

from flint import arb

from substructures.certificate.compare import compare
from substructures.certificate.derived.model_at import ModelAt
from substructures.certificate.derived.model_formulas import Expectation
from substructures.certificate.outputs import Outputs
from substructures.certificate.states import EXACT, states_between
from substructures.certificate.stored import pruned
from substructures.errors import VerificationFailed
from substructures.expr.direct import Given, ball
from substructures.expr.program import Program
from substructures.tree.model import Model

#: outputs of a model: the equations of motion with their closures
DYNAMICS = ("metric", "bias", "forces", "potential_energy", "closure.residual", "closure.jacobian", "g_a0", "g_00")


def certified(
    program: Program,
    model: Model,
    expectation: Expectation,
    what: str,
    *,
    needs: Iterable[str] = DYNAMICS,
    zero: Iterable[str] = (),
    more: Mapping[str, str] | None = None,
) -> Program:
    """The program, once every element was found to be what ``expectation`` makes of the certified one of the model;
    marked are outputs that have no finite value to be compared with, and all where the model has outputs that are.

    ``needs``: outputs of the model that it is made of; ``zero``: symbols of the model that were put to 0; ``more``:
    kinds of symbols beside those of the model and their variations ``d.*``. Raises VerificationFailed, which says
    ``what`` is wrong.
    """
    nothing, source = dict.fromkeys(zero, arb(0)), pruned(model.program, needs)

    def expected(values: Mapping[str, Any]) -> Outputs:
        """At a state."""
        return expectation(ModelAt(source, model.coordinates, {**values, **nothing}))

    kinds = kinds_of(model)
    kinds |= {f"d.{name}": kind for name, kind in kinds.items()} | dict(more or {})
    given = {name: parameter.get("value") for name, parameter in model.parameters.items()}
    defaults = {name: _exact(value) for name, value in given.items() if value is not None}
    try:
        found = compare(program, kinds, expected, defaults, states_between(program.operations, source.operations))
    except VerificationFailed as error:
        raise VerificationFailed(f"{what}: {error}") from None
    return program.marked(program.outputs if model.program.not_judged & set(needs) else found.not_judged)


@lru_cache(maxsize=4096)
def _exact(value: Given) -> Any:
    """A default, which every tree of a part has."""
    return ball(value, precision=EXACT)


def kinds_of(model: Model) -> dict[str, str]:
    """The kinds of all symbols that formulas of a model may have, by name."""
    kinds = {symbol.name: symbol.kind for symbol in model.program.symbols} | {"t": "time"}
    for name in model.coordinates:
        kinds |= {name: "coordinate", f"{name}'": "velocity", f"{name}''": "acceleration"}
    kinds |= dict.fromkeys(model.positions, "coordinate")
    return kinds | dict.fromkeys(model.parameters, "parameter") | dict.fromkeys(model.input_names, "input")
