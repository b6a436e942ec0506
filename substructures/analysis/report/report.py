"""A tree told to people: what it is, what its formulas are, and what can be said of them in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from substructures.analysis.report.bodies import body_statements
from substructures.analysis.report.influence import influence_statements
from substructures.analysis.report.omission import omission_statements
from substructures.analysis.report.rest import rest_of, rest_statements
from substructures.analysis.report.singular import singular_statements
from substructures.analysis.report.sizes import SMALL, STATES, ElementSizes, element_sizes, missing_values, sampled
from substructures.analysis.report.statements import (
    MARK,
    Names,
    Statement,
    christoffel_statements,
    force_statements,
    metric_statements,
    symmetry_statements,
)
from substructures.errors import listed
from substructures.expr.hoist import hoisted
from substructures.expr.operations import Symbol
from substructures.expr.program import Program
from substructures.part.definition import Definition
from substructures.printers.language import Language, Listing
from substructures.printers.names import short_names
from substructures.printers.render import LIMIT, readable, renamed
from substructures.printers.text import Text
from substructures.printers.textbook import TextbookTerms
from substructures.quantities.numbers.defaults import default_numbers
from substructures.quantities.numbers.limits import joint_limits
from substructures.quantities.regressor_model import RegressorModel
from substructures.tree.given.ties import require_untied
from substructures.tree.model import Model

#: what is printed, and what it is called
QUANTITIES = {
    "metric": "Mass matrix",
    "christoffel": "Christoffel symbols of the first kind",
    "g_a0": "Metric of the given motions, g_a0",
    "Gamma_ab0": "Velocity forces beside the given motions, Gamma_ab0",
    "Gamma_a00": "Inertia forces of the given motions, Gamma_a00",
    "forces": "Generalised forces",
}
SECTIONS = {
    "metric": "Structure of the mass matrix",
    "christoffel": "Structure of the Christoffel symbols",
    "forces": "What acts",
    "symmetries": "Symmetries and first integrals",
    "rest": "Rest and small vibrations",
    "parameters": "Which parameters matter most",
    "omissions": "What may be left out",
    "singular": "Where the mass matrix is singular",
}
#: sections that are about no quantity, and stand behind all of them
CONCLUSIONS = tuple(name for name in SECTIONS if name not in QUANTITIES)


@dataclass(frozen=True)
class Source:
    """Where a part of the tree comes from."""

    instance: str
    name: str
    title: str
    source: str
    license: str


@dataclass(frozen=True)
class Coordinate:
    """``called``: its name for people; ``low``, ``high``: joint limits, None where there are none."""

    name: str
    called: str
    joint: str
    unit: str
    low: float | None
    high: float | None


@dataclass(frozen=True)
class SymbolRow:
    """A symbol of the formulas with its default value in SI."""

    name: str
    called: str
    kind: str
    unit: str
    value: float | None
    description: str


@dataclass(frozen=True)
class Heading:
    """What the report is about: ``title`` and ``description`` of a part, ``notes``: what was assumed; ``address``: path
    of a stored tree, whose requests tell more.
    """

    name: str
    title: str = ""
    description: str = ""
    digest: str = ""
    notes: tuple[str, ...] = ()
    address: str = ""


@dataclass(frozen=True)
class Printed:
    """A quantity in a language: ``terms`` of its textbook form, if it has one; ``reason``: why it is compact."""

    language: Language
    listing: Listing
    terms: TextbookTerms | None
    reason: str

    @property
    def said(self) -> tuple[str, ...]:
        """What is said before the formulas: why they are compact, and what the names of steps mean."""
        return (self.reason, *self.language.legend) if self.reason else ()


@dataclass(frozen=True)
class Report:
    """``shown``: the programs of the quantities with names for people; ``called``: these by name of the tree."""

    heading: Heading
    model: Model = field(repr=False)
    coordinates: tuple[Coordinate, ...]
    symbols: tuple[SymbolRow, ...]
    statements: tuple[Statement, ...]
    sources: tuple[Source, ...]
    shown: Mapping[str, Program] = field(repr=False)
    called: Mapping[str, str] = field(repr=False)
    glossary: Program | None = field(default=None, repr=False)

    def printed(self, quantity: str, language: type[Language], limit: int = LIMIT) -> Printed:
        """A quantity: the textbook form where it takes about a second at most and its lines can be read, otherwise the
        compact one.

        Raises TooLarge (size, limit).
        """
        program = self.shown[quantity]
        return Printed(*readable(lambda: language(program), limit, self.glossary))

    def sizes(self, metric: Printed) -> tuple[list[ElementSizes], str]:
        """The terms of the elements of the metric by size, and why there are none."""
        if metric.terms is None:
            return [], "the mass matrix has no textbook form that is quick to find"
        missing = missing_values(self.model, self.model.program.select(["metric"]))
        if missing:
            return [], f"parameters without a value: {listed(missing)}"
        program = self.shown["metric"]
        names = {short: name for name, short in self.called.items()}
        called = [names[s.name] for s in program.symbols]
        return element_sizes(self.model, program, called, metric.terms.reading), ""

    @cached_property
    def ranges(self) -> dict[str, list[float]]:
        """The range that every coordinate was sampled in."""
        return sampled(self.model)[1]

    def plain(self, limit: int = LIMIT) -> dict[str, Any]:
        """Plain data: statements in words and as lists, sizes of terms as text and number. Raises TooLarge."""
        metric = self.printed("metric", Text, limit)
        sizes, reason = self.sizes(metric)
        entries = [
            {
                "entry": list(each.index),
                "terms": [
                    {"formula": _text(metric, t), "largest_share": t.share, "is_small": t.is_small} for t in each.terms
                ],
            }
            for each in sizes
        ]
        told = {"threshold": SMALL, "states": STATES, "ranges": self.ranges, "entries": entries}
        heading = {k: x for k, x in vars(self.heading).items() if k != "address"} | {"notes": list(self.heading.notes)}
        return heading | {
            "dof": self.model.dof,
            "indices_from": 0,
            "coordinates": [vars(each) for each in self.coordinates],
            "symbols": [vars(each) for each in self.symbols],
            "statements": [each.plain() for each in self.statements],
            "sizes": told | {"reason": reason or None},
            "sources": [vars(each) for each in self.sources],
        }


def _text(metric: Printed, term: Any) -> str:
    if metric.terms is None:
        raise TypeError("a textbook form is expected")
    return metric.language.finished(metric.terms.text(term.term))


def report(
    model: Model,
    definitions: Mapping[str, Definition],
    heading: Heading,
    glossary: Program | None = None,
    regressor: RegressorModel | None = None,
) -> Report:
    """The report about a model; ``definitions``: of its parts, by instance; ``glossary``: names of steps
    (:mod:`substructures.tree.glossary`); ``regressor``: of the tree, for what is said of whole bodies.

    Statements count the elements of arrays from 1 in words (g[1,2]) and from 0 in lists. Sizes of terms and rest are at
    the default values of the parameters, sizes over states in the limits of the joints. Formulas are printed when they
    are asked for. Raises TooLarge then, InvalidDocument for ball joints and velocity constraints.
    """
    require_untied(model, "report")
    quantities = [name for name in QUANTITIES if name in model.program.outputs]
    whole = model.program.select(quantities)
    known, units = {s.name: s for s in whole.symbols}, model.state_units["q"]
    known |= {name: Symbol(name, "coordinate", units[name]) for name in model.coordinates if name not in known}
    called = dict(zip(known, short_names(list(known.values())), strict=True))
    shown = {name: _renamed(hoisted(whole.select([name])), called) for name in quantities}
    marked = {name: f"{MARK}{short}{MARK}" for name, short in called.items()}
    statements = _statements(model, marked, heading.address, regressor)
    sources = tuple(Source(instance, d.name, d.title, d.source, d.license or "") for instance, d in definitions.items())
    return Report(
        heading, model, _coordinates(model, called), _symbols(model, known, called), tuple(statements), sources, shown,
        called, None if glossary is None else renamed(glossary, called),
    )  # fmt: skip


def _statements(model: Model, marked: Names, address: str, regressor: RegressorModel | None) -> list[Statement]:
    """All that is said, in the order of the sections."""
    rest = rest_of(model)
    return [
        *metric_statements(model, marked),
        *christoffel_statements(model, marked),
        *force_statements(model, marked),
        *symmetry_statements(model, marked),
        *rest_statements(model, marked, rest, address),
        *influence_statements(model, marked, rest, address),
        *omission_statements(model, marked, address),
        *body_statements(model, marked, regressor, address),
        *singular_statements(model, marked, address),
    ]


def _renamed(program: Program, called: Mapping[str, str]) -> Program:
    return replace(program, symbols=tuple(replace(s, name=called.get(s.name, s.name)) for s in program.symbols))


def _coordinates(model: Model, called: Mapping[str, str]) -> tuple[Coordinate, ...]:
    limits = joint_limits(model).plain()
    found = []
    for name, kind in zip(model.coordinates, model.joints, strict=True):
        joint, unit = ("revolute", "rad") if kind == "R" else ("prismatic", "m")
        ends = [x if abs(x) < float("inf") else None for x in limits.get(name, ())] or [None, None]
        found.append(Coordinate(name, called[name], joint, unit, ends[0], ends[1]))
    return tuple(found)


def _symbols(model: Model, known: Mapping[str, Symbol], called: Mapping[str, str]) -> tuple[SymbolRow, ...]:
    values = default_numbers(model.parameters)
    return tuple(
        SymbolRow(
            name,
            called[name],
            s.kind,
            s.unit,
            values.get(name),
            str(model.parameters.get(name, {}).get("description") or ""),
        )
        for name, s in sorted(known.items())
    )


def told_sizes(report: Report) -> str:
    """What the shares of terms mean, as a sentence, with names between marks."""
    some = list(report.ranges.items())[:12]
    ranges = "; ".join(f"{MARK}{report.called[name]}{MARK} in [{low:.3g}, {high:.3g}]" for name, (low, high) in some)
    return (
        f"The largest share that every term of an element has in the sum of the absolute values of its terms, over "
        f"{STATES} random states ({ranges}) at the default values of the parameters. Terms below {100 * SMALL:g} % "
        "everywhere are small."
    )


def percent(share: float) -> str:
    """A share as people write it."""
    return f"{100 * share:.3g} %" if share >= 1e-4 else "less than 0.01 %"


def some_terms(sizes: ElementSizes, most: int = 6) -> tuple[Sequence[Any], str]:
    """The largest terms of an element, small ones among them, and what is said of the others."""
    shown, rest = sizes.terms[:most], sizes.terms[most:]
    small = sum(t.is_small for t in rest)
    if not rest:
        return shown, ""
    told = f"{len(rest)} more term{'s' if len(rest) > 1 else ''} of at most {percent(rest[0].share)}"
    return shown, told + (f", {small} of them small" if small else "")
