"""The formats, and the choice between compact and expanded form."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import prod
from typing import Any, NamedTuple

from substructures.errors import InvalidDocument, TooLarge
from substructures.expr.operations import MAX_ELEMENTS
from substructures.expr.program import Program
from substructures.printers.definitions import Definitions, defined, joined
from substructures.printers.language import Language, Listing
from substructures.printers.latex import Latex
from substructures.printers.latex_document import LatexDocument
from substructures.printers.listing import compact, expanded, inlined
from substructures.printers.mathml import MathML
from substructures.printers.meanings import LETTERS, OUTPUTS, Label, meanings
from substructures.printers.names import instance_of, short_names
from substructures.printers.stored import stored_form
from substructures.printers.text import Text
from substructures.printers.textbook import TextbookTerms, at_once, textbook, textbook_inlined

LANGUAGES: Mapping[str, type[Language]] = {
    "text": Text,
    "latex": Latex,
    "latex-document": LatexDocument,
    "mathml": MathML,
}

#: media type of every format
FORMATS: Mapping[str, str] = {"json": "application/json", **{name: lang.media for name, lang in LANGUAGES.items()}}
FORMS = ("readable", "textbook", "compact", "expanded")
_LISTINGS: Mapping[str, Callable[[Program, Language, int], Listing]] = {
    "compact": compact,
    "expanded": expanded,
    "textbook": textbook,
}
#: nodes of a rendered program, and of formulas without temporaries
LIMIT = 100_000
#: nodes from which on a derivation has names for its steps
NAMED = 60
#: characters of a line, from which on a derivation with names reads better
LONGEST = 1000
INLINE_LIMIT = 20_000


def write(
    program: Program,
    format: str,  # noqa: A002 -- the name in the contract
    form: str = "compact",
    name: str = "model",
    limit: int = LIMIT,
    definitions: Definitions | None = None,
    glossary: Program | None = None,
    notes: Sequence[str] = (),
) -> str:
    """A program in one of FORMATS; :func:`substructures.export.render` writes it in languages, too.

    ``compact``: temporaries for shared subexpressions, then the independent non-zero elements of every output;
    ``expanded``: every element as canonical sum (:mod:`substructures.expr.rings.expand`); ``textbook``: every element
    collected, factored and cancelled (:mod:`substructures.textbook`); ``readable``: ``textbook`` in formats for people
    where that takes no more than about a second, otherwise ``compact``. ``name`` is what the text calls it;
    ``definitions``: of symbols that stand for formulas, which are printed first (not in JSON); ``glossary``: what
    intermediate quantities are called in the compact form of formats for people
    (:mod:`substructures.printers.meanings`); ``notes``: what readers must know, put first in formats for people.
    Raises InvalidDocument for an unknown format or form, TooLarge (size,
    limit) when more than ``limit`` nodes would be printed, ZeroDivisionError when there is no expanded form.
    """
    if format not in FORMATS:
        raise InvalidDocument.at("/format", "unknown-format", f"{format[:40]!r} is not one of {', '.join(FORMATS)}")
    check_form(form)
    if form == "readable":
        return _readable(program, format, name, limit, definitions, glossary, notes)
    if format == "json":
        return stored_form(program, form, limit)
    for output in program.outputs.values():
        if prod(output.shape) > MAX_ELEMENTS:
            raise TooLarge("an array (in elements)", prod(output.shape), MAX_ELEMENTS)
    said = _Said(program, definitions, limit)
    spoken, language = _spoken(said.program, format)
    if form == "compact":
        name_steps(language, _in_names_of(glossary, said.program, spoken))
    language.legend = [*notes, *language.legend]
    return language.render(said.with_definitions(_LISTINGS[form](spoken, language, limit), language), name)


def name_steps(language: Language, glossary: Program | None) -> None:
    """Let the language call quantities what they are, and say what the letters mean."""
    if glossary is None or not language.is_for_people or len(language.program.reachable()) < NAMED:
        return
    language.meanings = _distinct(meanings(language.program, glossary), language)
    used = {(label.key, label.is_barred) for label in language.meanings.values()}
    said = [
        f"{key.partition('.')[0]}{' with a bar' * is_barred}: {text}"
        for key, text in LETTERS.items()
        for is_barred in (False, True)
        if (key, is_barred) in used
    ]
    language.legend = ["joints are numbered from 1, in the order of the coordinates", *said] if said else []


def _distinct(found: Mapping[int, Label], language: Language) -> dict[int, Label]:
    """Names that no symbol and no element of an output looks like: with a bar all of a letter of which one does."""
    double = {label.kind for label in found.values() if not language.is_free(language.labelled(label))}
    barred = {kind for kind in double if language.bars}
    labels = {
        i: label if label.is_of_angle else label._replace(is_barred=label.kind in barred) for i, label in found.items()
    }
    quantities = language.program.outputs
    return {
        i: label
        for i, label in labels.items()
        if language.is_free(language.labelled(label)) and OUTPUTS.get(label.key) not in quantities
    }


def _readable(
    program: Program,
    format: str,  # noqa: A002 -- the name in the contract
    name: str,
    limit: int,
    definitions: Definitions | None,
    glossary: Program | None,
    notes: Sequence[str],
) -> str:
    """The textbook form where it fits, otherwise the compact one with the reason."""
    if format == "json" or not LANGUAGES[format].is_for_people:
        return write(program, format, "compact", name, limit, definitions, glossary, notes)
    said = _Said(program, definitions, limit)
    found = readable(
        lambda: _spoken(said.program, format)[1],
        limit,
        _in_names_of(glossary, said.program, _spoken(said.program, format)[0]),
    )
    found.language.legend = [*notes, *([found.reason] if found.reason else []), *found.language.legend]
    return found.language.render(said.with_definitions(found.listing, found.language), name)


class Readable(NamedTuple):
    """A listing in a language; ``terms``: of its textbook form, if there is one; ``reason``: why it is not that."""

    language: Language
    listing: Listing
    terms: TextbookTerms | None
    reason: str = ""


def readable(make: Callable[[], Language], limit: int, glossary: Program | None) -> Readable:
    """A program in its textbook form, or as a derivation: where that is not quick to find, or has lines that nobody
    reads and the glossary has names. ``make``: the language of the program. Raises TooLarge.
    """
    language = make()
    program = language.program
    try:
        terms = TextbookTerms(program, language, limit, at_once(program))
    except (TooLarge, ZeroDivisionError) as error:
        steps, listing = _derivation(make(), limit, glossary)
        return Readable(steps, listing, None, f"compact, since there is no textbook form: {error}")
    longest = _longest(terms, program, limit)
    if longest > LONGEST:
        steps, listing = _derivation(make(), limit, glossary)
        if steps.meanings and 2 * len(steps.meanings) >= len(listing.temporaries):
            terms = TextbookTerms(program, make(), limit, abbreviates=False, reading=terms.reading)
            reason = f"a derivation, since the textbook form has lines of up to {longest:,} characters"
            return Readable(steps, listing, terms, reason)
    return Readable(language, terms.listing, terms)


def _derivation(language: Language, limit: int, glossary: Program | None) -> tuple[Language, Listing]:
    name_steps(language, glossary)
    return language, compact(language.program, language, limit)


def _longest(terms: TextbookTerms, program: Program, limit: int) -> int:
    """Characters of the longest element as text, whatever the language is."""
    as_text = TextbookTerms(program, Text(program), limit, reading=terms.reading).listing
    return max((len(x) for some in as_text.entries.values() for x in some), default=0)


class _Said:
    """A program with the definitions of those of its symbols that occur: ``program`` has the symbols of both."""

    def __init__(self, program: Program, definitions: Definitions | None, limit: int) -> None:
        self.program, self.limit, self.own = program, limit, definitions and definitions.of(program)
        if self.own and self.own.program.outputs:
            self.program, self.defining = joined(program, self.own.program)

    def with_definitions(self, listing: Listing, language: Language) -> Listing:
        """The listing with what symbols stand for, in the names of the language. Raises TooLarge."""
        if not self.own or not self.own.program.outputs:
            return listing
        before, spoken = language.occurring, language.program.symbols
        names = {s.name: other.name for s, other in zip(self.program.symbols, spoken, strict=True)}
        found = defined(replace(self.defining, symbols=spoken), names, language, self.limit)
        # those of the formulas, and those of what their symbols stand for
        called = {names[name] for name in self.defining.outputs}
        own = {n for n, s in enumerate(spoken) if s.name in called}
        language.occurring = None if before is None or language.occurring is None else before | language.occurring | own
        notes = (self.own.notes.get(name, "") for name in self.defining.outputs)
        return replace(listing, definitions=tuple((*pair, note) for pair, note in zip(found, notes, strict=True)))


def first_index(format: str) -> int:  # noqa: A002 -- the name in the contract
    """What indices count from in one of FORMATS: 1 where people or the language do, else 0."""
    return LANGUAGES[format].first if format in LANGUAGES else 0


def entries(
    program: Program,
    output: str,
    format: str = "text",  # noqa: A002 -- the name in the contract
    form: str = "compact",
    limit: int = INLINE_LIMIT,
) -> list[dict[str, Any]]:
    """The independent non-zero elements of one output: ``[{"index": [a, b, c], "formula": text}]``.

    Indices count from 0. Every formula stands alone (no temporaries). All other elements follow from the symmetry
    (:func:`symmetry_rule`) or are zero. Raises KeyError for an unknown output, TooLarge like :func:`write`.
    """
    part = program.select([output])
    if format not in LANGUAGES:
        raise InvalidDocument.at("/format", "unknown-format", f"{format[:40]!r} is not one of {', '.join(LANGUAGES)}")
    check_form(form)
    form = "compact" if form == "readable" else form
    # what stands alone, and may be read by a program, has the names of the tree
    part, language = _spoken(part, format) if form == "textbook" else (part, LANGUAGES[format](part))
    listing = {**_LISTINGS, "compact": inlined, "textbook": textbook_inlined}[form](part, language, limit)
    texts = [language.finished(text) for text in listing.entries[output]]
    return [{"index": list(i), "formula": x} for i, x in zip(part.outputs[output].index, texts, strict=True)]


def _spoken(program: Program, format: str) -> tuple[Program, Language]:  # noqa: A002 -- the name in the contract
    """The language, and the program with the names that it writes: for people without instances that are clear."""
    if not LANGUAGES[format].is_for_people:
        return program, LANGUAGES[format](program)
    named = list(zip(program.symbols, short_names(program.symbols), strict=True))
    language = LANGUAGES[format](replace(program, symbols=tuple(replace(s, name=name) for s, name in named)))
    owners = {instance_of(s.name) for s, name in named if s.name != name} - {None}
    language.remark = "".join(f"all names but those of the tree are of instance {owner}" for owner in owners)
    return language.program, language


def _in_names_of(glossary: Program | None, program: Program, spoken: Program) -> Program | None:
    """A glossary in the names of a program as it is spoken; symbols that this has not are called like nothing there."""
    return (
        None
        if glossary is None
        else renamed(glossary, {s.name: other.name for s, other in zip(program.symbols, spoken.symbols, strict=True)})
    )


def renamed(glossary: Program, called: Mapping[str, str]) -> Program:
    """A glossary with other names of symbols; the others are called like nothing that there is."""
    symbols = tuple(replace(s, name=called.get(s.name, f"?{s.name}")) for s in glossary.symbols)
    return replace(glossary, symbols=symbols)


def check_form(form: str) -> None:
    """Raises InvalidDocument for an unknown form."""
    if form not in FORMS:
        raise InvalidDocument.at("/form", "unknown-form", f"{form[:40]!r} is not one of {', '.join(FORMS)}")
