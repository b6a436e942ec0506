"""Units of measurement: their dimension and the exact factor to SI.

The usual spellings of SI units are known here; everything else (prefixes, inches, degrees, ...) is read by pint, which
takes a second to load and is loaded when such a unit first occurs. Factors are exact: a rational times a power of pi.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import cache, lru_cache
from importlib import import_module
from math import inf
from threading import Lock
from typing import Any

from substructures.errors import meant

#: exponents of m, kg, s, A, K, mol, cd
Dimension = tuple[Fraction | int, ...]
BASE = ("m", "kg", "s", "A", "K", "mol", "cd")
NUMBER: Dimension = (0,) * len(BASE)
MAX_LENGTH = 64

#: usual spellings: exponents of m, kg, s, rad; of several units of one dimension the first is the one that is written
_SI: dict[str, tuple[int, int, int, int]] = {
    "1": (0, 0, 0, 0), "rad": (0, 0, 0, 1), "m": (1, 0, 0, 0), "kg": (0, 1, 0, 0), "s": (0, 0, 1, 0),
    "m^2": (2, 0, 0, 0), "m^3": (3, 0, 0, 0), "1/m": (-1, 0, 0, 0), "s^2": (0, 0, 2, 0),
    "1/s": (0, 0, -1, 0), "Hz": (0, 0, -1, 0), "1/s^2": (0, 0, -2, 0), "rad/s": (0, 0, -1, 1), "rad/s^2": (0, 0, -2, 1),
    "m/s": (1, 0, -1, 0), "m/s^2": (1, 0, -2, 0), "kg/m": (-1, 1, 0, 0), "kg/m^2": (-2, 1, 0, 0),
    "kg/m^3": (-3, 1, 0, 0), "kg m": (1, 1, 0, 0), "kg m^2": (2, 1, 0, 0), "kg m/s": (1, 1, -1, 0),
    "N s": (1, 1, -1, 0), "kg m^2/s": (2, 1, -1, 0), "N m s": (2, 1, -1, 0), "N": (1, 1, -2, 0), "N m": (2, 1, -2, 0),
    "Nm": (2, 1, -2, 0), "J": (2, 1, -2, 0), "W": (2, 1, -3, 0), "Pa": (-1, 1, -2, 0), "N/m": (0, 1, -2, 0),
    "N/m^2": (-1, 1, -2, 0), "N s/m": (0, 1, -1, 0), "kg/s": (0, 1, -1, 0), "N m/rad": (2, 1, -2, -1),
    "Nm/rad": (2, 1, -2, -1), "N m s/rad": (2, 1, -1, -1), "Nms/rad": (2, 1, -1, -1), "N/rad": (1, 1, -2, -1),
    "N m s/rad^2": (2, 1, -1, -2), "N s/m^2": (-1, 1, -1, 0), "m/rad": (1, 0, 0, -1), "rad/m": (-1, 0, 0, 1),
}  # fmt: skip
#: other units that may have been meant by one that is not known
_USUAL = ("mm", "cm", "km", "inch", "g", "t", "ms", "min", "deg", "deg/s", "rpm", "kN", "N mm", "bar", "N/mm")
_WRITTEN: dict[Dimension, str] = {}
for _text, _exponents in _SI.items():
    _WRITTEN.setdefault(_exponents, _text)

#: root units of pint: index in BASE, and how many of ours one is
_ROOTS = {"meter": 0, "gram": 1, "kilogram": 1, "second": 2, "ampere": 3, "kelvin": 4, "mole": 5, "candela": 6}
_GRAM = Fraction(1, 1000)
#: what may be handed on: names with small exponents, products, quotients and parentheses, no other number than 1
_EXPONENT = r"(?:\s*(?:\^|\*\*)\s*(?:\(\s*)?[-+]?\d{1,2}(?![\d.])(?:\s*\))?|[⁺⁻]?[⁰¹²³⁴⁵⁶⁷⁸⁹]{1,2})?"
_TEXT = re.compile(rf"(?:[\s()*/·⋅]|1(?![\d.])|(?:[^\W\d]\w*|[°%]){_EXPONENT})+")
_POWERS_OF_PI = range(-8, 9)
#: newton metres written as one word, which pint takes for a measure of yarn
_NEWTON_METRE = re.compile(r"\b([kMmu\u00b5]?N)(c?m?m)(s?)\b")
_lock = Lock()


class UnknownUnitError(ValueError):
    """A unit that is not known, or that has no exact factor to SI."""


@dataclass(frozen=True, slots=True)
class Unit:
    """One of it is ``factor * pi**pi`` of the unit ``si``, which is a product of SI units."""

    dimension: Dimension
    si: str
    factor: Fraction = Fraction(1)
    pi: int = 0

    @property
    def is_si(self) -> bool:
        """Whether numbers in it are what they are in SI."""
        return self.factor == 1 and not self.pi

    def in_si(self, value: int | Decimal | str) -> int | Decimal | str:
        """The exact SI value of so many: a number, or an expression where no decimal is exact (``"1/3*pi"``)."""
        if self.is_si:
            return value
        if isinstance(value, str):
            return f"({value})*{_written(self.factor, self.pi)}"
        exact = Fraction(value) * self.factor
        plain = None if self.pi and exact else _decimal(exact)
        return _written(exact, self.pi) if plain is None else plain

    @property
    def scale(self) -> float:
        """The factor as a double; infinite beyond their range."""
        exact = self.factor * Fraction(_registry_pi()) ** self.pi if self.pi else self.factor
        try:
            return float(exact)
        except OverflowError:
            return inf


def _written(factor: Fraction, pi: int) -> str:
    return str(factor) + (f"*pi^{pi}" if pi not in (0, 1) else "*pi" * pi)


def _decimal(exact: Fraction) -> int | Decimal | None:
    """The number as a decimal, None where it has none that ends."""
    rest, places = exact.denominator, 0
    for p in (2, 5):
        count = 0
        while rest % p == 0:
            rest, count = rest // p, count + 1
        places = max(places, count)
    if rest != 1:
        return None
    if not places:
        return exact.numerator
    digits = abs(exact.numerator) * 10**places // exact.denominator
    return Decimal((int(exact < 0), tuple(map(int, str(digits))), -places))


@lru_cache(maxsize=4096)
def read_unit(text: str) -> Unit:
    """The unit of a text such as ``N m/rad``, ``kg*m**2`` or ``deg``. Raises UnknownUnitError.

    >>> read_unit("mm").in_si(1200), read_unit("deg").in_si(30)
    (Decimal('1.2'), '1/6*pi')
    """
    usual = " ".join(text.replace("**", "^").replace("*", " ").replace("·", " ").split())
    known = _SI.get(usual)
    if known is not None:
        return Unit((*known[:3], 0, 0, 0, 0), text)
    if len(text) > MAX_LENGTH or not _TEXT.fullmatch(text):
        raise UnknownUnitError(f"'{text[:MAX_LENGTH]}' is no unit; expected for example mm, N m/rad or kg*m^2")
    with _lock:
        return _read_by_pint(text)


def _read_by_pint(text: str) -> Unit:
    pint, words = _registry(), _NEWTON_METRE.sub(r"\1 \2 \3", text)
    try:
        one, none = (pint.Quantity(Fraction(n), pint.parse_units(words)).to_root_units() for n in (1, 0))
        factor, roots = Fraction(one.magnitude), {str(name): Fraction(n) for name, n in one.unit_items()}
    except Exception:  # whatever pint raises: undefined names, logarithmic units, unbalanced parentheses
        like = meant(text, [*_SI, *_USUAL]) or "; there are for example mm, deg, N m/rad and kg*m^2"
        raise UnknownUnitError(f"the unit '{text}' is not known{like}") from None
    if none.magnitude != 0:
        raise UnknownUnitError(f"the unit '{text}' counts from a zero of its own and has no factor to SI")
    exponents, radians = [Fraction(0)] * len(BASE), roots.pop("radian", Fraction(0))
    for name, n in roots.items():
        if name not in _ROOTS or (name == "gram" and n.denominator != 1):
            raise UnknownUnitError(f"the unit '{text}' has no exact factor to SI")
        exponents[_ROOTS[name]] += n
        factor *= _GRAM ** int(n) if name == "gram" else 1
    # pint's pi has fifty digits: the power of pi that leaves the shortest fraction is the one that was meant
    pi = Fraction(_registry_pi())
    power = min(_POWERS_OF_PI, key=lambda k: (_length(factor / pi**k), abs(k)))
    dimension = tuple(int(n) if n.denominator == 1 else n for n in exponents)
    return Unit(dimension, _si_text(dimension, int(radians)), factor / pi**power, power)


def _length(x: Fraction) -> int:
    return x.numerator.bit_length() + x.denominator.bit_length()


@cache
def _registry() -> Any:
    """Pint's units with exact numbers."""
    return import_module("pint").UnitRegistry(non_int_type=Fraction)


@cache
def _registry_pi() -> Fraction:
    """The rational that stands for pi in pint's definitions."""
    return Fraction(_registry().Quantity(Fraction(1), "pi").to_root_units().magnitude)


def si_text(dimension: Dimension) -> str:
    """The SI unit of a dimension as text, ``1`` of a pure number."""
    return _si_text(dimension, 0)


def _si_text(dimension: Dimension, radians: int) -> str:
    known = None if any(dimension[3:]) else _WRITTEN.get((*dimension[:3], radians))
    return known or " ".join(_powers(dimension, radians)) or "1"


def _powers(dimension: Dimension, radians: int) -> Iterator[str]:
    for name, n in zip((*BASE, "rad"), (*dimension, radians), strict=True):
        if n:
            yield name if n == 1 else f"{name}^{n}" if n == int(n) else f"{name}^({n})"


def si_unit(unit: str) -> str:
    """The SI unit of what was given in a unit; a text of old that is no unit stays as it is."""
    try:
        return read_unit(unit).si if unit else unit
    except UnknownUnitError:
        return unit
