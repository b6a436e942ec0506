"""``group=true``: formulas of a tree in its base parameters, with what was grouped into what."""

from __future__ import annotations

from typing import Any

from service.content.cache import Cache
from service.messages.refusals import unprocessable
from service.models.binding import bound
from service.models.printing import JSON, TO_READ, Style, text_of
from service.models.source import Source
from substructures.analysis.identification.base_parameters import base_parameters
from substructures.analysis.identification.grouped import (
    OUTPUTS,
    Grouped,
    GroupedSymbol,
    cut,
    formulas_of,
    grouped_model,
    sum_of,
)
from substructures.errors import InvalidInput, TooLarge
from substructures.export import Interface
from substructures.printers.definitions import Definitions
from substructures.printers.render import LIMIT
from substructures.quantities.quantity import DERIVED, PROGRAMS
from substructures.quantities.sources import Sources

#: what follows from the equations of motion alone, and has formulas in grouped symbols
QUANTITIES = (
    *OUTPUTS,
    *(name for name in DERIVED if name not in OUTPUTS and {*PROGRAMS[name].needs.split()} <= {*OUTPUTS}),
)

_grouped: Cache[Grouped] = Cache(300_000, lambda found: len(found.model.program))


def check_group(quantity: str, style: Style) -> None:
    """Raise Refused 422 for a quantity that base parameters do not determine, and for formats of code."""
    if quantity not in QUANTITIES:
        message = f"'{quantity[:80]}' has no formulas in grouped symbols; these have: {', '.join(QUANTITIES)}"
        raise unprocessable("not-grouped", message, "/query/group")
    if style.format not in (JSON, *TO_READ):
        message = f"functions take the parameters of the tree; grouped symbols are in {', '.join((JSON, *TO_READ))}"
        raise unprocessable("not-grouped", message, "/query/group")


def grouped_of(source: Source) -> Grouped:
    """The model in grouped symbols, remembered. Raises InvalidInput for closures, TooLarge, TypeError without parts."""
    key = source.digest, source.model.program.digest, source.regressor().program.digest, source.limits.program_nodes
    found = _grouped.get(key)
    if found is None:
        if source.parts is None:
            raise TypeError("grouped symbols need the parts of the tree")
        base = base_parameters(source.regressor())
        found = grouped_model(*source.parts(), source.model, base, source.limits.program_nodes)
        _grouped.put(key, found)
    return found


def grouped_text(source: Source, quantity: str, style: Style, interface: Interface, limit: int | None = None) -> str:
    """A quantity in grouped symbols in the format chosen. Raises as :func:`grouped_of` and ``text_of``."""
    check_group(quantity, style)
    try:
        found = grouped_of(source)
    except InvalidInput as error:
        raise error.moved(lambda _: "/query/group") from None
    parameters = found.model.parameters
    program = bound(Sources(found.model).formulas(quantity), parameters, style.bind)
    definitions = Definitions(
        bound(found.definitions, parameters, style.bind), {s.name: cut(sum_of(s.standard)) for s in found.symbols}
    )
    members: dict[str, Any] = {}
    if style.format == JSON:
        used = definitions.of(program)
        members["definitions"] = [_described(s, used) for s in found.symbols if s.name in used.program.outputs]
    most = LIMIT if limit is None else limit
    return text_of(program, style, quantity, interface, members, most, definitions)


def _described(symbol: GroupedSymbol, used: Definitions) -> dict[str, Any]:
    """What a symbol stands for: ``formula`` in parameters (null where it is too long), ``standard`` as sums."""
    try:
        formula = formulas_of(used.program.select([symbol.name]))[symbol.name]
    except TooLarge:
        formula = None
    named = {"name": symbol.name, "unit": symbol.unit, "base": symbol.named_by, "formula": formula}
    return {**named, "combination": dict(symbol.standard)}
