"""Three motions in a plane that close a loop: where they are, in closed form.

Turns about points and slides along directions, one after the other, each given where all three are at zero:

    X_1 X_2 X_3 = K          K x = k (x - a) + b          x, a, b, k complex, |k| = 1

This is the planar four-bar family: three turns are the triangle of two links and the line between their ends (four-bar
of F. Freudenstein, 1955), two turns and a slide those of slider-cranks, one turn and two slides that of Scotch yokes.
With p_i the points, z_1 = e^(i t_1) (p_2 - p_1), z_2 = e^(i (t_1 + t_2)) (p_3 - p_2):

    three turns     z_1 + z_2 = g = K p_3 - p_1,  z_1 = ((G + A - B) + e i S) g / 2 G
                    S = sqrt(4 G A - (G + A - B)^2)      G = |g|^2, A = |z_1|^2, B = |z_2|^2
    a slide last    z_1 = K p_2 - p_1 - s d,  t_1 + t_2 = arg k        d = k e_3, h = K p_2 - p_1
                    s = Re(h d*) + e S,  S = sqrt(A - Im(h d*)^2)
    two slides      t_1 = arg k,  s_2 e_2 + s_3 e_3 = k* (K p_1 - p_1)

The sign e is that of the branch. Other orders follow from X_2 X_3 (K^-1 X_1 K) = K; the sides z_1 and z_2 are those of
single bodies, where two are. Where a known point v has |v - p_1|^2 = A and |K p_3 - v|^2 = B, or these exchanged, as in
parallelograms, z_1 follows without a root: v - p_1 (K p_3 - v), and its mirror image g^2 z_1* / G.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from substructures.expr.graph import Expr

Complex = tuple[Expr, Expr]


@dataclass(frozen=True)
class Motion:
    """A turn about the point ``at``, or a slide along the unit vector ``at``; ``length2``: the square of the distance
    of a turn from the next one, of the last from the first, where one body holds both.
    """

    is_turn: bool
    at: Complex
    length2: Expr | None = None


@dataclass(frozen=True)
class Closing:
    """K: x -> turn (x - start) + end."""

    turn: Complex
    start: Complex
    end: Complex

    def of(self, x: Complex) -> Complex:
        """K x."""
        return plus(times(self.turn, minus(x, self.start)), self.end)

    def back(self, x: Complex) -> Complex:
        """K^-1 x."""
        return plus(times(conjugate(self.turn), minus(x, self.end)), self.start)


@dataclass(frozen=True)
class Solution:
    """Cosines and sines of the turns, by place in the order that was given, and of sums of two neighbours; slides."""

    turns: dict[tuple[int, ...], Complex]
    slides: dict[int, Expr]


def solutions(three: Sequence[Motion], K: Closing, known: Sequence[Complex] = ()) -> Iterator[Solution]:
    """All of them: one or two; ``known``: points that may be corners, too. Raises ZeroDivisionError where points that
    have to be apart coincide, ValueError for three slides.
    """
    order, slides = [0, 1, 2], sum(not each.is_turn for each in three)
    if slides == 3:
        raise ValueError("three slides")
    motions = list(three)
    # X_2 X_3 (K^-1 X_1 K) = K: the first motion goes to the end, until the order is that of a formula below
    for _ in range(3):
        if _is_in_order(motions, slides):
            break
        order, motions = [*order[1:], order[0]], [*motions[1:], _moved_to_the_end(motions[0], K)]
    for found in (_three_turns, _slide_last, _two_slides)[slides](motions, K, known):
        turns = {tuple(sorted(order[k] for k in places)): x for places, x in found.turns.items()}
        yield Solution(turns, {order[k]: s for k, s in found.slides.items()})


def _is_in_order(motions: Sequence[Motion], slides: int) -> bool:
    """Whether the motion that the formulas take last, or first, is there."""
    if slides:
        return not motions[2].is_turn if slides == 1 else motions[0].is_turn
    # the side that no body holds is g: the two others are constant lengths, and shorter formulas
    return motions[2].length2 is None and motions[0].length2 is not None


def _moved_to_the_end(first: Motion, K: Closing) -> Motion:
    """K^-1 X_1 K."""
    at = K.back(first.at) if first.is_turn else times(conjugate(K.turn), first.at)
    return replace(first, at=at)


def _three_turns(motions: Sequence[Motion], K: Closing, known: Sequence[Complex]) -> Iterator[Solution]:
    one, two, three = motions
    a, b, g = minus(two.at, one.at), minus(three.at, two.at), minus(K.of(three.at), one.at)
    A, B, G = _length2(one, a), _length2(two, b), square(g)
    for z, w in _sides(g, (A, B, G), [minus(v, one.at) for v in known]):
        # e^(i t_1) = z_1 a* / A;  e^(i t_2) = z_1* z_2 a b* / A B;  e^(i (t_1 + t_2)) = z_2 b* / B
        first = over(times(z, conjugate(a)), A)
        both = over(times(w, conjugate(b)), B)
        second = over(times(times(times(conjugate(z), w), a), conjugate(b)), A * B)
        third = times(K.turn, conjugate(both))
        yield Solution({(0,): first, (1,): second, (0, 1): both, (2,): third}, {})


def _sides(g: Complex, squares: tuple[Expr, Expr, Expr], known: Sequence[Complex]) -> Iterator[tuple[Complex, Complex]]:
    """z_1 and z_2; ``known``: points seen from p_1."""
    A, B, G = squares
    for v in known:
        for z in (v, minus(g, v)):
            if (square(z) - A).is_zero and (square(minus(g, z)) - B).is_zero:
                mirrored = over(times(times(g, g), conjugate(z)), G)
                yield z, minus(g, z)
                yield mirrored, minus(g, mirrored)
                return
    along = G + A - B
    S = G.graph.sqrt(4 * G * A - along * along)
    for sign in (1, -1):
        z = times((along / (2 * G), S * sign / (2 * G)), g)
        yield z, minus(g, z)


def _length2(turn: Motion, x: Complex) -> Expr:
    return square(x) if turn.length2 is None else turn.length2


def _slide_last(motions: Sequence[Motion], K: Closing, _: Sequence[Complex]) -> Iterator[Solution]:
    one, two, slide = motions
    a, h, d = minus(two.at, one.at), minus(K.of(two.at), one.at), times(K.turn, slide.at)
    A, (along, across) = _length2(one, a), times(h, conjugate(d))
    # both turns have one centre: only their sum is told
    if A.is_zero:
        raise ZeroDivisionError
    root = A.graph.sqrt(A - across * across)
    for S in (root, -root):
        # z_1 = d (-e S + i Im(h d*))
        first = over(times(times(d, (-S, across)), conjugate(a)), A)
        yield Solution({(0,): first, (1,): times(K.turn, conjugate(first)), (0, 1): K.turn}, {2: along + S})


def _two_slides(motions: Sequence[Motion], K: Closing, _: Sequence[Complex]) -> Iterator[Solution]:
    turn, two, three = motions
    w = times(conjugate(K.turn), minus(K.of(turn.at), turn.at))
    # 0 for parallel slides, which do not tell how far: ZeroDivisionError
    det = cross(two.at, three.at)
    yield Solution({(0,): K.turn}, {1: cross(w, three.at) / det, 2: cross(two.at, w) / det})


def plus(x: Complex, y: Complex) -> Complex:
    """x + y."""
    return x[0] + y[0], x[1] + y[1]


def minus(x: Complex, y: Complex) -> Complex:
    """x - y."""
    return x[0] - y[0], x[1] - y[1]


def times(x: Complex, y: Complex) -> Complex:
    """x y."""
    return x[0] * y[0] - x[1] * y[1], x[0] * y[1] + x[1] * y[0]


def over(x: Complex, y: Expr) -> Complex:
    """x / y."""
    return x[0] / y, x[1] / y


def conjugate(x: Complex) -> Complex:
    """x*."""
    return x[0], -x[1]


def cross(x: Complex, y: Complex) -> Expr:
    """Im(x* y)."""
    return x[0] * y[1] - x[1] * y[0]


def square(x: Complex) -> Expr:
    """|x|^2."""
    return x[0] * x[0] + x[1] * x[1]
