"""How two parts or two revisions of a tree differ, and what it means for the equations of motion, in words."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from substructures.documents import read_json
from substructures.errors import SubstructuresError
from substructures.expr.graph import Graph
from substructures.interchange.difference.documents import Change, applied, changes
from substructures.interchange.difference.formulas import QuantityDifference, compared
from substructures.interchange.difference.sides import of_model, of_part
from substructures.part.definition import Definition
from substructures.part.part import Part, draft
from substructures.tree.document import TreeSpec
from substructures.tree.model import Model

#: of so many changes the effect of each one is looked at by itself
SINGLE = 12
#: quantities that words tell of, and what these call them
TOLD = {
    "metric": "M",
    "christoffel": "Gamma",
    "gravity": "gravity",
    "forces": "Q",
    "applied": "Q",
    "position": "places",
}
#: relative changes from which on percents say little
MANIFOLD = 10
#: entries of a quantity that are listed
LISTED = 200


@dataclass(frozen=True)
class Difference:
    """``definition``: fields; ``quantities``: formulas; ``words``: both, a sentence for each change."""

    definition: tuple[Change, ...]
    quantities: tuple[QuantityDifference, ...]
    words: tuple[str, ...]
    units: Mapping[str, str]

    @property
    def is_none(self) -> bool:
        """Whether the documents and the formulas are the same."""
        return not self.definition and not any(each.differing for each in self.quantities)

    def plain(self) -> dict[str, Any]:
        """As JSON data."""
        return {
            "same": self.is_none,
            "words": list(self.words),
            "definition": [each.plain(self.units) for each in self.definition],
            "quantities": {each.name: each.plain(LISTED) for each in self.quantities},
        }


def of_parts(a: Part, b: Part, admit: Callable[[int], None] | None = None) -> Difference:
    """Two versions of a part, or two parts. Where there are several changes, what each of them does alone is derived,
    unless ``admit`` raises.
    """
    graph = Graph()
    left, right = (read_json(side.definition.canonical()) for side in (a, b))
    found = [each for each in changes(left, right) if each.path != ("name",)]
    quantities = compared(graph, of_part(graph, a), of_part(graph, b))
    units = {name: str(x["unit"]) for name, x in {**a.parameters, **b.parameters}.items()}

    def effect(change: Change) -> Sequence[QuantityDifference] | None:
        """What a change alone does to the first part; None where it cannot be made alone."""
        try:
            definition = Definition.read(applied(left, change))
            single = draft(definition, admit=admit)
            return compared(graph, of_part(graph, a), of_part(graph, single))
        except (SubstructuresError, LookupError, ZeroDivisionError):
            return None

    return Difference(tuple(found), tuple(quantities), _words(found, quantities, units, effect), units)


def of_trees(
    a: tuple[TreeSpec, Model], b: tuple[TreeSpec, Model], parts: Sequence[tuple[str, Part, Part]]
) -> Difference:
    """Two revisions of a tree, or two trees; ``parts``: instances that both have, with another part in each."""
    graph = Graph()
    left, right = (read_json(spec.canonical()) for spec, _ in (a, b))
    found = [each for each in changes(left, right) if each.path != ("name",)]
    for instance, x, y in parts:
        inner = changes(read_json(x.definition.canonical()), read_json(y.definition.canonical()))
        place = ("instances", instance, "definition")
        found += [Change((*place, *each.path), each.kind, each.a, each.b) for each in inner if each.path != ("name",)]
    quantities = compared(graph, of_model(graph, a[1]), of_model(graph, b[1]))
    units = {name: str(x.get("unit", "")) for model in (a[1], b[1]) for name, x in model.parameters.items()}
    return Difference(tuple(found), tuple(quantities), _words(found, quantities, units, lambda _: None), units)


def _words(
    found: Sequence[Change],
    quantities: Sequence[QuantityDifference],
    units: Mapping[str, str],
    effect: Callable[[Change], Sequence[QuantityDifference] | None],
) -> tuple[str, ...]:
    acting = [each for each in found if not each.is_words]
    lines = []
    for change in found:
        done: Sequence[QuantityDifference] | None = None
        if change in acting:
            done = quantities if len(acting) == 1 else effect(change) if len(acting) <= SINGLE else None
        lines.append(change.told(units) + (f": {_told(done)}" if done is not None else ""))
    if len(acting) != 1 and any(each.differing for each in quantities):
        lines.append(f"together: {_told(quantities)}")
    return tuple(lines) or ("nothing differs",)


def _told(quantities: Sequence[QuantityDifference]) -> str:
    """``changes 12 of 21 entries of M, at most 4 %``."""
    by_name = {each.name: each for each in quantities if each.moved}
    told = [
        f"{by_name[name].moved} of {by_name[name].entries} entries of {called}{_most(by_name[name])}"
        for name, called in TOLD.items()
        if name in by_name
    ]
    return f"changes {'; '.join(told)}" if told else "changes no numbers of the equations of motion at the defaults"


def _percent(change: float) -> str:
    """Two digits; a whole number from ten percent on.

    >>> _percent(0.00123), _percent(0.156), _percent(1.0)
    ('0.12', '16', '100')
    """
    return f"{100 * change:.2g}" if 100 * change < 10 else f"{100 * change:.0f}"


def _most(quantity: QuantityDifference) -> str:
    """The largest change in words."""
    added = quantity.count("new") + quantity.count("gone")
    if quantity.change is None:
        return ""
    size = f", at most {_percent(quantity.change)} %" if quantity.change < MANIFOLD else ", more than tenfold"
    return size + (f", {added} of them new or gone" if added else "")
