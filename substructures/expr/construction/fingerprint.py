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

#: (cos, sin) of an angle modulo a prime
Point = tuple[int, int]
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


def point_of(t: int, prime: int) -> Point:
    """((1 - t^2)/(1 + t^2), 2t/(1 + t^2)). Raises ValueError where t^2 = -1, which has no root for prime = 3 mod 4."""
    inverse = pow(1 + t * t, -1, prime)
    return (1 - t * t) * inverse % prime, 2 * t * inverse % prime


def added(a: Point, b: Point, prime: int) -> Point:
    """The point of the sum of two angles."""
    return (a[0] * b[0] - a[1] * b[1]) % prime, (a[0] * b[1] + a[1] * b[0]) % prime


def multiplied(point: Point, n: int, prime: int) -> Point:
    """The point of n times an angle, n any integer."""
    if n < 0:
        point, n = (point[0], -point[1] % prime), -n
    result = (1, 0)
    while n:
        if n & 1:
            result = added(result, point, prime)
        point, n = added(point, point, prime), n >> 1
    return result


_points: dict[object, Point] = {}


def circle_point(key: object) -> Point:
    """(cos, sin) of the angle with this key: a random point of the circle."""
    found = _points.get(key)
    if found is None:
        found = point_of(keyed("angle", key), PRIME)
        if len(_points) > 100_000:
            _points.clear()
        _points[key] = found
    return found
