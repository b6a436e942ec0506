"""Points (cos, sin) of angles modulo a prime: the circle over a finite field, with the addition theorem."""

from __future__ import annotations

Point = tuple[int, int]


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
