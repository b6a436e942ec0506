"""Expressions in pieces that are their text when they are joined, so that other names can be put in it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from substructures.expr.steps import CURVES, LAWS, MEASURES, RESERVED
from substructures.expr.syntax import tokens


def pieces(text: str) -> Iterator[tuple[str, str]]:
    """An expression in pieces: (``name`` of a value, ``frame`` of a measure or nothing, the piece); the mark of a
    rate is a piece of its own. Raises ExpressionError.

    >>> list(pieces("2e3*q'"))
    [('', '2e3'), ('', '*'), ('name', 'q'), ('', "'")]
    """
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
