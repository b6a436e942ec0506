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
from substructures.part.derive import draft
from substructures.part.part import Part
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
    """``definition``: fields; ``quantities``: formulas; ``words``: both, a sentence for each change; ``reference``: how
    one with a digest is called.
    """

    definition: tuple[Change, ...]
    quantities: tuple[QuantityDifference, ...]
    words: tuple[str, ...]
    units: Mapping[str, str]
    reference: Callable[[str], str] = str

    @property
    def is_none(self) -> bool:
        """Whether the documents and the formulas are the same."""
        return not self.definition and not any(each.differing for each in self.quantities)

    def plain(self) -> dict[str, Any]:
        """As JSON data."""
        return {
            "same": self.is_none,
            "words": list(self.words),
            "definition": [each.plain(self.units, self.reference) for each in self.definition],
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

    told = _Told(units, _coordinates(a.coordinates, b.coordinates))
    return Difference(tuple(found), tuple(quantities), told.words(found, quantities, effect), units)


def of_trees(
    a: tuple[TreeSpec, Model],
    b: tuple[TreeSpec, Model],
    parts: Sequence[tuple[str, Part, Part]],
    reference: Callable[[str], str] = str,
) -> Difference:
    """Two revisions of a tree, or two trees; ``parts``: instances that both have, with another part in each;
    ``reference``: how one with a digest is called.
    """
    graph = Graph()
    left, right = (read_json(spec.canonical()) for spec, _ in (a, b))
    found = [each for each in changes(left, right) if each.path != ("name",)]
    for instance, x, y in parts:
        inner = changes(read_json(x.definition.canonical()), read_json(y.definition.canonical()))
        place = ("instances", instance, "definition")
        found += [Change((*place, *each.path), each.kind, each.a, each.b) for each in inner if each.path != ("name",)]
    quantities = compared(graph, of_model(graph, a[1]), of_model(graph, b[1]))
    units = {name: str(x.get("unit", "")) for model in (a[1], b[1]) for name, x in model.parameters.items()}
    told = _Told(units, _coordinates(a[1].coordinates, b[1].coordinates), reference)
    words = told.words(found, quantities, lambda _: None)
    return Difference(tuple(found), tuple(quantities), words, units, reference)


@dataclass(frozen=True)
class _Coordinates:
    """Of both sides: how many, those of both, and those of one alone."""

    counts: tuple[int, int]
    common: tuple[str, ...]
    gone: tuple[str, ...]
    new: tuple[str, ...]

    @property
    def told(self) -> str:
        """In words, where they are not the same; what follows is about the common ones."""
        changes = "; ".join(f"{', '.join(x)} {word}" for x, word in ((self.gone, "gone"), (self.new, "new")) if x)
        compared_in = f"compared in {', '.join(self.common)}" if self.common else "with none in common to compare in"
        return f"coordinates {self.counts[0]} -> {self.counts[1]} ({changes}), {compared_in}"


def _coordinates(a: Sequence[str], b: Sequence[str]) -> _Coordinates:
    common = tuple(name for name in a if name in b)
    gone, new = (tuple(name for name in names if name not in common) for names in (a, b))
    return _Coordinates((len(a), len(b)), common, gone, new)


@dataclass(frozen=True)
class _Told:
    """What is needed to tell of changes in words."""

    units: Mapping[str, str]
    coordinates: _Coordinates
    reference: Callable[[str], str] = str

    def words(
        self,
        found: Sequence[Change],
        quantities: Sequence[QuantityDifference],
        effect: Callable[[Change], Sequence[QuantityDifference] | None],
    ) -> tuple[str, ...]:
        """A line for each change, and for all together. A default that is there on one side alone has no effect."""
        acting = [each for each in found if not each.is_words and not each.is_default]
        is_same = not self.coordinates.gone and not self.coordinates.new
        lines = [] if is_same else [self.coordinates.told]
        for change in found:
            done: Sequence[QuantityDifference] | None = None
            if change in acting and (is_same or self.coordinates.common):
                done = quantities if len(acting) == 1 else effect(change) if len(acting) <= SINGLE else None
            told = f": {self._effect(done)}" if done is not None else ""
            lines.append(change.told(self.units, self.reference) + told)
        has_common = is_same or self.coordinates.common
        if len(acting) != 1 and has_common and any(each.differing for each in quantities):
            lines.append(f"together: {self._effect(quantities)}")
        return tuple(lines) or ("nothing differs",)

    def _effect(self, quantities: Sequence[QuantityDifference]) -> str:
        """``changes 12 of 21 entries of M, at most 4 %``; with other coordinates of the entries of common ones."""
        alone = {*self.coordinates.gone, *self.coordinates.new}
        by_name = {each.name: each for each in (each.without(alone) for each in quantities) if each.moved}
        told = [
            f"{'' if alone else f'{by_name[name].moved} of {by_name[name].entries} '}"
            f"entries of {called}{_most(by_name[name])}"
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
