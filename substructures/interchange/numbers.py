"""Numbers of files: exact decimals as they are written; doubles where something is computed of them."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from decimal import Decimal
from fractions import Fraction

from substructures.interchange.report import Place, refuse

#: an exact decimal, or a multiple of pi as text
Number = Decimal | str
Triple = tuple[Number, Number, Number]

ZERO = Decimal(0)
ONE = Decimal(1)
ORIGIN: Triple = (ZERO, ZERO, ZERO)
#: a multiple of pi / 12 that an angle is meant to be, if it is as near as that
ANGLE_TOLERANCE = 1e-11
_DECIMAL = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d{1,3})?")
_MAX_DIGITS = 60
#: of sums of some products, relative to their terms
ROUNDING = 1e-15
#: ratios of the entries of a direction have denominators up to this, where it is in whole numbers
_MOST_WHOLE = 12
_DIGITS_OF_PEOPLE = 9


def number_of(text: str, place: Place, name: str) -> Decimal:
    """A finite decimal number of at most 60 digits and magnitudes from 1e-100 to 1e100. Raises InvalidDocument."""
    word = text.strip()
    if len(word) > _MAX_DIGITS or not _DECIMAL.fullmatch(word):
        hint = "; decimals are written with a point" if "," in word else ""
        raise refuse(place, "bad-number", f"'{name}' is no finite number: '{word[:_MAX_DIGITS]}'{hint}")
    found = Decimal(word)
    if found and not -100 <= found.adjusted() <= 100:
        raise refuse(place, "bad-number", f"'{name}' is beyond 1e-100 to 1e100: {word}")
    return found if found else ZERO


def is_number(text: str) -> bool:
    """Whether a text is a decimal number, of any length."""
    return bool(_DECIMAL.fullmatch(text.strip()))


def value(x: Number) -> float:
    """The number as a double."""
    if isinstance(x, Decimal):
        return float(x)
    sign, numerator, denominator = _PI.fullmatch(x).groups()  # type: ignore[union-attr] # written by multiple_of_pi
    return (-1 if sign else 1) * float(Fraction(int(numerator or 1), int(denominator or 1))) * math.pi


_PI = re.compile(r"(-)?(?:(\d+)\*)?pi(?:/(\d+))?")


def decimal_of(x: float) -> Decimal:
    """A computed double to 16 significant digits; zero below 1e-100."""
    return Decimal(f"{x:.16g}") if abs(x) > 1e-100 else ZERO


def cleaned(numbers: Iterable[float], scale: float = 0.0) -> tuple[Decimal, ...]:
    """Computed doubles as decimals: what is within rounding of a number of twelve digits is this one.

    ``scale``: of what they were computed of, where that is larger than they are.

    >>> cleaned([0.1 + 0.2, 1.1e-16, 1 / 3])
    (Decimal('0.3'), Decimal('0'), Decimal('0.3333333333333333'))
    """
    given = [float(x) for x in numbers]
    size = max(scale, *map(abs, given), 0.0)
    if not 0 < size < math.inf:
        return tuple(map(decimal_of, given))
    digits = 12 - math.floor(math.log10(size))
    short = [round(x, digits) for x in given]
    return tuple(decimal_of(y if abs(x - y) < ROUNDING * size else x) for x, y in zip(given, short, strict=True))


def undusted(numbers: tuple[Number, ...]) -> tuple[Number, ...]:
    """Numbers of a file, without what programs that wrote it left of rounding: entries below 1e-15 of the largest."""
    least = ROUNDING * max((abs(value(x)) for x in numbers), default=0.0)
    return tuple(ZERO if abs(value(x)) < least else x for x in numbers)


def direction(xyz: Sequence[float]) -> Triple:
    """A vector in the direction of another one, in whole numbers where it is so to within 1e-11.

    >>> direction([0.7071067811865475, 1.1e-16, -0.7071067811865476]), direction([0.6, 0.0, 0.8])
    ((Decimal('1'), Decimal('0'), Decimal('-1')), (Decimal('3'), Decimal('0'), Decimal('4')))
    """
    largest = max(map(abs, xyz))
    ratios = [Fraction(x / largest).limit_denominator(_MOST_WHOLE) for x in xyz]
    if any(abs(x / largest - r) > ANGLE_TOLERANCE for x, r in zip(xyz, ratios, strict=True)):
        return triple(cleaned(xyz))
    whole = math.lcm(*(r.denominator for r in ratios))
    return triple(tuple(Decimal(int(r * whole)) for r in ratios))


def axis_of(xyz: Triple) -> Triple:
    """An axis of a file as it is given; in whole numbers where it is so to within 1e-11, and is written with more
    digits than a person would.
    """
    is_computed = any(isinstance(x, Decimal) and len(x.as_tuple().digits) > _DIGITS_OF_PEOPLE for x in xyz)
    return direction([value(x) for x in xyz]) if is_computed else xyz


def triple(xyz: tuple[Number, ...]) -> Triple:
    """Three numbers as a triple."""
    x, y, z = xyz
    return x, y, z


def angle(x: Number) -> Number:
    """The angle [rad], as an exact multiple of pi / 12 where it is one to within 1e-11.

    >>> angle(Decimal("1.57079632679")), angle(Decimal("1.5708"))
    ('pi/2', Decimal('1.5708'))
    """
    if isinstance(x, str):
        return x
    steps = round(float(x) * 12 / math.pi)
    if abs(float(x) - steps * math.pi / 12) > ANGLE_TOLERANCE:
        return x
    return multiple_of_pi(Fraction(steps, 12))


def multiple_of_pi(ratio: Fraction) -> Number:
    """So many times pi, as text: '-pi/2', '2*pi/3', 0."""
    if not ratio:
        return ZERO
    top = abs(ratio.numerator)
    bottom = "" if ratio.denominator == 1 else f"/{ratio.denominator}"
    return ("-" if ratio < 0 else "") + ("" if top == 1 else f"{top}*") + "pi" + bottom


def is_zero(x: Number) -> bool:
    """Whether a number is zero as written."""
    return isinstance(x, Decimal) and not x
