"""Sums that are a product of sums but for one term: ``(a + b)*(c + d) - e^2*cos(q)^2`` for its five terms.

Determinants of mass matrices are such sums. With sin^2 + cos^2 = 1 the term is looked for among those with a square of
a sine or cosine: r*sin(q)^2 = r - r*cos(q)^2, and what then is before - r*cos(q)^2 may have factors. First all of these
terms are one, (u + v)^2*cos(q)^2, then each of them alone.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from flint import fmpq_mpoly

from substructures.textbook.work import Work

#: terms of a sum, the fewest and the most, and terms that are tried
FEWEST, MOST, TRIED = 4, 40, 12


def but_for_one_term(
    poly: fmpq_mpoly, square: int, other: int, work: Work
) -> Iterator[tuple[Any, list[tuple[Any, int]], Any]]:
    """Number, factors and the term besides of all such forms of a polynomial.

    ``square`` and ``other`` are the generators sin(q) and cos(q), or cos(q) and sin(q); no square of ``other`` occurs.
    """
    if not FEWEST <= len(poly) <= MOST:
        return
    context = poly.context()
    terms = [(tuple(map(int, k)), c) for k, c in poly.to_dict().items()]
    found = sorted((k, c) for k, c in terms if k[square] == 2 and not k[other])
    alone = [context.term(coeff=c, exp_vec=tuple(n if i != square else 0 for i, n in enumerate(k))) for k, c in found]
    for rest in ([sum(alone[1:], alone[0])] if len(alone) > 1 else []) + alone[:TRIED]:
        number, parts = work.factor(poly - rest * context.gen(square) ** 2 + rest)
        if sum(n for part, n in parts if len(part) > 1) > 1:
            yield number, parts, -rest * context.gen(other) ** 2
