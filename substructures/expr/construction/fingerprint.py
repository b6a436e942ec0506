"""Values of functions at one secret random point of a prime field (notation.md, section 8.3).

A node of the expression graph carries the value of its formula in the field of a random 120-bit prime,
with random values for symbols and, for every angle, a random point on the circle. Two formulas with equal
values are equal as functions, with an error probability of about degree / 2**119 (Schwartz 1980, Zippel 1979).
The prime and the point are drawn once per process and never leave it, since constants could be crafted against
a known point. Everything the field knows is a homomorphism: the addition theorems, the squares of the square
roots of 2, 3, 5 and 7; whatever else (exp, atan2, other roots) is an independent random value.
"""

from __future__ import annotations

import secrets
from fractions import Fraction
from hashlib import blake2b

from substructures.expr.construction.circle import point_of

_ROOTS = (2, 3, 5, 7)
_WITNESSES = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41)


def _is_prime(n: int) -> bool:
    """Miller-Rabin; for n = 3 mod 4 a witness needs no squarings."""
    return all(pow(w, (n - 1) // 2, n) in (1, n - 1) for w in _WITNESSES)


def _draw_prime() -> int:
    """A random prime of 120 bits, 3 mod 4, modulo which 2, 3, 5 and 7 are squares."""
    while True:
        n = (secrets.randbits(117) | 1 << 116) * 8 + 7
        if all(n % p for p in _WITNESSES) and all(pow(r, (n - 1) // 2, n) == 1 for r in _ROOTS) and _is_prime(n):
            return n


PRIME = _draw_prime()
_KEY = secrets.token_bytes(32)
_SQRT = {r: pow(r, (PRIME + 1) // 4, PRIME) for r in _ROOTS}


def keyed(*key: object) -> int:
    """The random field element that belongs to a key (the same for the same key throughout the process)."""
    return int.from_bytes(blake2b(repr(key).encode(), key=_KEY, digest_size=24).digest()) % PRIME


def rational(value: int | Fraction) -> int:
    """Image of an exact number."""
    if isinstance(value, int):
        return value % PRIME
    return value.numerator * pow(value.denominator, -1, PRIME) % PRIME


def square_root(value: int) -> int | None:
    """Image of the square root of a square-free product of 2, 3, 5 and 7; None for other numbers."""
    root = 1
    for p, root_of_p in _SQRT.items():
        if value % p == 0:
            value, root = value // p, root * root_of_p % PRIME
    return root if value == 1 else None


_points: dict[object, tuple[int, int]] = {}


def circle_point(key: object) -> tuple[int, int]:
    """(cos, sin) of the angle with this key: a random point of the circle."""
    found = _points.get(key)
    if found is None:
        found = point_of(keyed("angle", key), PRIME)
        if len(_points) > 100_000:
            _points.clear()
        _points[key] = found
    return found
