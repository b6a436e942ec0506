"""Sine and cosine as a function of WebAssembly, which has none: the reduction and the polynomials of the compiler."""

from __future__ import annotations

from collections.abc import Sequence

from substructures.compile.sincos import COSINE, LIMIT, P1, P2, P3, SINE, TWO_OVER_PI
from substructures.export.webassembly.encoding import I32, Body


def sincos(sine_import: int, cosine_import: int) -> Body:
    """``(x) -> (sin x, cos x)``: x = k pi/2 + r, polynomials in r, exchanged and signed by k mod 4.

    For |x| >= 2^17, infinities and NaN the functions of the host answer.
    """
    b = Body(1)
    x, k, r, z, s, c = 0, *(b.local() for _ in range(5))
    q = b.local(I32)
    _beyond(b, x, sine_import, cosine_import)
    _reduce(b, x, k, r)
    b.get(r)
    b.do("f64.mul")
    b.set(z)
    _sine(b, r, z)
    b.set(s)
    _cosine(b, z)
    b.set(c)
    b.get(k)
    b.do("i32.trunc_f64_s")
    b.set(q)
    _turned(b, q, 0, (s, c))
    _turned(b, q, 1, (c, s))
    return b


def _reduce(b: Body, x: int, k: int, r: int) -> None:
    """k and r = x - k pi/2, which is left on the stack, too."""
    b.get(x)
    b.number(TWO_OVER_PI)
    b.do("f64.mul", "f64.nearest")
    # -0 becomes 0, so that -0 - k P1 stays -0
    b.number(0.0)
    b.do("f64.add")
    b.set(k)
    b.get(x)
    for part in (P1, P2, P3):
        b.get(k)
        b.number(part)
        b.do("f64.mul", "f64.sub")
    b.tee(r)


def _sine(b: Body, r: int, z: int) -> None:
    """sin r = r + r z S(z), with the sign of r also at -0."""
    b.get(r)
    b.get(r)
    b.get(z)
    b.do("f64.mul")
    _polynomial(b, z, SINE)
    b.do("f64.mul", "f64.add")
    b.get(r)
    b.do("f64.copysign")


def _cosine(b: Body, z: int) -> None:
    """cos r = 1 + z (z C(z) - 1/2)."""
    b.get(z)
    b.get(z)
    _polynomial(b, z, COSINE)
    b.do("f64.mul")
    b.number(0.5)
    b.do("f64.sub", "f64.mul")
    b.number(1.0)
    b.do("f64.add")


def _beyond(b: Body, x: int, sine_import: int, cosine_import: int) -> None:
    """Return what the host answers unless |x| < LIMIT."""
    b.get(x)
    b.do("f64.abs")
    b.number(LIMIT)
    b.do("f64.lt", "i32.eqz")
    b.begin_if()
    for function in (sine_import, cosine_import):
        b.get(x)
        b.call(function)
    b.do("return", "end")


def _polynomial(b: Body, z: int, coefficients: Sequence[float]) -> None:
    """Horner's scheme."""
    b.number(coefficients[-1])
    for coefficient in coefficients[-2::-1]:
        b.get(z)
        b.do("f64.mul")
        b.number(coefficient)
        b.do("f64.add")


def _turned(b: Body, q: int, shift: int, values: tuple[int, int]) -> None:
    """The second value for odd q, with the opposite sign where (q + shift) mod 4 is 2 or 3."""
    even, odd = values
    chosen = b.local()
    b.get(odd)
    b.get(even)
    b.get(q)
    b.integer(1)
    b.do("i32.and", "select")
    b.tee(chosen)
    b.do("f64.neg")
    b.get(chosen)
    b.get(q)
    b.integer(shift)
    b.do("i32.add")
    b.integer(2)
    b.do("i32.and", "select")
