"""Names of a tree as names of one part, and expressions with other names in them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from substructures.documents.fields import Quantity, in_si
from substructures.documents.units import read_unit
from substructures.errors import InvalidDocument
from substructures.expr.steps import CURVES, LAWS, MEASURES, RESERVED
from substructures.expr.syntax import MAX_LENGTH, tokens

#: longest name
LONGEST = 64
#: what a name stands for: another name, a number, or an expression
Value = Any


@dataclass
class Names:
    """Names that are taken, each once: ``arm.q1`` is ``arm_q1``, or ``arm_q1_2`` where that is taken."""

    taken: set[str] = field(default_factory=lambda: {*RESERVED, "base"})

    def new(self, *words: str) -> str:
        """A free name out of words."""
        whole = "_".join(words)
        for number in range(1, len(self.taken) + 2):
            ending = "" if number == 1 else f"_{number}"
            name = whole[: LONGEST - len(ending)] + ending
            if name not in self.taken:
                self.taken.add(name)
                return name
        raise AssertionError("of n + 1 names one is free where n are taken")


def names_of(text: str) -> Iterator[str]:
    """The names in an expression, without the marks of rates; of what cannot be read none."""
    return (token for kind, token in _pieces(text) if kind == "name")


def renamed(value: Value, lookup: Callable[[str], Value], pointer: str, frame: Callable[[str], str] = str) -> Value:
    """A number or expression with other names, or with what names stand for, in it.

    ``lookup``: of a name, without the mark of a rate; ``frame``: of a frame in a measure. Raises InvalidDocument for
    expressions that become too long.

    >>> renamed("2*l + q'", {"l": "arm_l", "q": "arm_q"}.__getitem__, "")
    "2*arm_l + arm_q'"
    >>> renamed("l", {"l": 3}.__getitem__, ""), renamed("l^2", {"l": "a + b"}.__getitem__, "")
    (3, '(a + b)^2')
    >>> renamed("k*distance'(a.tip, a.base)", str, "", lambda at: at.replace(".", "_"))
    "k*distance'(a_tip, a_base)"
    """
    if isinstance(value, Quantity):
        return value.model_dump()
    if isinstance(value, Mapping) or not isinstance(value, str):
        return value
    pieces = list(_pieces(value))
    if len(pieces) == 1 and pieces[0][0] == "name":
        return lookup(pieces[0][1])
    put_in: dict[str, Callable[[str], str]] = {"name": lambda name: _put_in(lookup(name)), "frame": frame, "": str}
    text = "".join(put_in[kind](piece) for kind, piece in pieces)
    if len(text) > MAX_LENGTH:
        message = f"with what its names are bound to, '{value[:80]}' has more than {MAX_LENGTH:,} characters"
        raise InvalidDocument.at(pointer, "too-long", message)
    return text


def _put_in(value: Value) -> str:
    """What a name stands for as a part of an expression."""
    plain = number_text(value)
    return plain if plain.isidentifier() or plain.replace(".", "", 1).isdigit() else f"({plain})"


def number_text(value: Value) -> str:
    """A number or expression as text, in SI."""
    if isinstance(value, Mapping):
        value = read_unit(value["unit"]).in_si(value["value"])
    value = in_si(value)
    return value if isinstance(value, str) else format(value, "f") if hasattr(value, "as_tuple") else str(value)


def _pieces(text: str) -> Iterator[tuple[str, str]]:
    """An expression in pieces: (``name`` of a value, ``frame`` of a measure or nothing, the piece)."""
    found, end = tokens(text), 0
    frames: set[int] = set()
    for k, (kind, token, column) in enumerate(found[:-1]):
        start = column - 1
        yield from _space(text[end:start])
        end = start + len(token)
        following = found[k + 1][1]
        if kind == "name" and token.removesuffix("'") in MEASURES and following == "(":
            # ( A , B )
            frames |= {k + 2, k + 4}
        if k in frames:
            yield "frame", token
        elif kind == "name" and not _has_meaning(token, following, found[k - 1][1] if k else ""):
            name = token.rstrip("'")
            yield "name", name
            yield from _space(token[len(name) :])
        else:
            yield "", token
    yield from _space(text[end:])


def _space(text: str) -> Iterable[tuple[str, str]]:
    return [("", text)] if text else []


def _has_meaning(word: str, following: str, before: str) -> bool:
    """Whether a name stands for a function, a constant or a word of the grammar."""
    is_called = following == "(" and (word in (*LAWS, "table") or word.removesuffix("'") in MEASURES)
    return word in RESERVED or is_called or (word in CURVES and before == ";")
