"""Steps of a derivation that are the negative of what has a name, A_2yy = -(a + b), and quotients by names.

The sign of a step is kept beside it and taken into sums and products: c - A_2yy for c + (a + b).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from substructures.expr.operations import Operation, operands
from substructures.expr.program import Program
from substructures.printers.language import ATOM, Language, Piece


class Signed(NamedTuple):
    """``piece`` with a sign; ``below``: what 1 is divided by; ``is_short``: as easily read as a name of its own."""

    piece: Piece
    is_negative: bool = False
    below: Piece | None = None
    is_short: bool = False

    def times(self, language: Language, is_negative: bool = False) -> Piece:
        """It, or its negative, with the sign."""
        return language.neg(self.piece) if self.is_negative != is_negative else self.piece


def signed(program: Program, i: int, written: Mapping[int, Signed], language: Language) -> Signed | None:
    """An operation of which operands are negatives or quotients; None of any other."""
    operation = program.operations[i]
    op, args = operation[0], [written[x] for x in operands(operation)]
    if (
        language.meanings
        and op in ("mul", "div")
        and (found := _short(op, args, language) or _quotient(args, language))
    ):
        return found
    if op == "neg" and language.meanings and args[0].piece.precedence == ATOM:
        return args[0]._replace(is_negative=not args[0].is_negative, is_short=True)
    if not any(a.is_negative for a in args):
        inner = operands(program.operations[operation[1]]) if op == "neg" else ()
        return Signed(args[0].piece, True) if any(written[x].is_negative for x in inner) else None
    return _of_negatives(operation, args, language)


def _of_negatives(operation: Operation, args: Sequence[Signed], language: Language) -> Signed:
    """The operation of pieces, the signs of which are taken into it, or become its own."""
    op, pieces, signs = operation[0], [a.piece for a in args], [a.is_negative for a in args]
    if op in ("add", "sub"):
        return _sum(op == "sub", pieces, signs, language)
    if op == "neg":
        return Signed(pieces[0])
    if op == "powi":
        return Signed(language.power(pieces[0], operation[2]), operation[2] % 2 == 1)
    if op in ("mul", "div"):
        return Signed(language.write(op, pieces), signs[0] != signs[1])
    return Signed(language.write(op, [a.times(language) for a in args]))


def _short(op: str, args: Sequence[Signed], language: Language) -> Signed | None:
    """One over a name, the square of a name."""
    a, b = args
    if b.piece.precedence != ATOM:
        return None
    if op == "div" and a.piece == language.one:
        return Signed(language.div(a.piece, b.piece), b.is_negative, b.piece, True)
    return Signed(language.power(a.piece, 2), is_short=True) if op == "mul" and a == b and language.powers else None


def _quotient(args: Sequence[Signed], language: Language) -> Signed | None:
    """a (1/b) as a/b."""
    for one, other in (args, args[::-1]):
        if other.below is not None and one.below is None:
            return Signed(language.div(one.piece, other.below), one.is_negative != other.is_negative)
    return None


def _sum(is_difference: bool, pieces: Sequence[Piece], signs: Sequence[bool], language: Language) -> Signed:
    a, b = pieces
    negative_a, negative_b = signs[0], signs[1] != is_difference
    if negative_a and negative_b:
        return Signed(language.add(a, b), True)
    if negative_a:
        return Signed(language.sub(b, a))
    return Signed(language.sub(a, b) if negative_b else language.add(a, b))
