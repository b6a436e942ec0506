"""Numbers as exact decimal text, with a limit on their digits."""

from __future__ import annotations

import re
from decimal import Decimal

MAX_DIGITS = 400
_TOO_LARGE = 10**MAX_DIGITS
TOO_LONG = f"a number of more than {MAX_DIGITS} digits"

INTEGER = re.compile(r"[-+]?(?:0|[1-9][0-9]*)")
REAL = re.compile(r"[-+]?(?:\.[0-9]+|(?:0|[1-9][0-9]*)(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?")


class RefusedNumberError(ValueError):
    """A number literal that is not finite or has too many digits."""


def integer(text: str) -> int:
    """The integer of a literal. Raises :class:`RefusedNumberError` when it is too long."""
    if len(text.lstrip("+-")) > MAX_DIGITS:
        raise RefusedNumberError(TOO_LONG)
    return int(text)


def decimal(text: str) -> Decimal:
    """The exact decimal of a literal. Raises :class:`RefusedNumberError` when it is too long."""
    if len(text) <= MAX_DIGITS and text.isascii() and "e" not in text and "E" not in text:
        return Decimal(text)
    mantissa, _, exponent = text.lower().partition("e")
    # the exponent is bounded before Decimal sees it: 1e999999999 must never be written out
    if len(exponent.lstrip("+-0")) > 4 or len(mantissa) > 2 * MAX_DIGITS:
        raise RefusedNumberError(TOO_LONG)
    value = Decimal(text)
    if plain_digits(value) > MAX_DIGITS:
        raise RefusedNumberError(TOO_LONG)
    return value


def not_finite(text: str) -> float:
    """Raises :class:`RefusedNumberError`: NaN and infinities are not numbers here."""
    raise RefusedNumberError(f"{text} is not a number")


def plain_digits(value: Decimal) -> int:
    """Number of digits of a finite decimal written without exponent."""
    _, digits, exponent = value.as_tuple()
    exponent = int(exponent)
    return len(digits) + exponent if exponent >= 0 else max(len(digits), 1 - exponent)


def plain_text(value: int | Decimal | float) -> str:
    """The decimal text without exponent and trailing zeros; equal numbers have equal texts (``-0`` is ``0``).

    A float stands for its shortest decimal text. Raises :class:`RefusedNumberError`.
    """
    if isinstance(value, int):
        if abs(value) >= _TOO_LARGE:
            raise RefusedNumberError(TOO_LONG)
        return str(value)
    # not repr(value), which numpy.float64 writes as np.float64(1.0)
    number = Decimal(float.__repr__(value)) if isinstance(value, float) else value
    if not number.is_finite():
        not_finite(str(value))
    text = str(number)
    if "E" in text.upper() or len(text) > MAX_DIGITS:
        if plain_digits(number) > MAX_DIGITS:
            raise RefusedNumberError(TOO_LONG)
        text = format(number, "f")
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return "0" if text == "-0" else text
