"""Sine and cosine of a vector: Cody-Waite reduction by pi/2 in three steps, and minimax polynomials.

x = k pi/2 + r, |r| <= pi/4; pi/2 = P1 + P2 + P3 with 33 bits in P1 and in P2, so that k P1 and k P2 are exact for
|k| < 2^20 (W. J. Cody & W. Waite, Software Manual for the Elementary Functions, 1980). The polynomials are minimax in
the relative error (2^-57.9 for the sine, 2^-63.9 for the cosine), found by the exchange algorithm of E. Ya. Remez with
60 digits: sin r = r + r^3 S(r^2), cos r = 1 + r^2 (r^2 C(r^2) - 1/2). Products and sums may be contracted (fused
multiply-add where the host has it). Results are within 1.5 units of the last place for |x| <= 100, within 2.5 up to
the limit, next to zeros included.
"""

from __future__ import annotations

from substructures.compile.assembler import AssemblyWriter

#: beyond this (and for infinities and NaN) the C library answers, lane by lane
LIMIT = 2.0**17

TWO_OVER_PI = 0.6366197723675814
P1, P2, P3 = 1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21
#: adding it rounds to an integer, which then stands in the low bits
ROUND = 1.5 * 2.0**52
SINE = (
    -0.1666666666666663,
    0.008333333333322108,
    -0.00019841269829580182,
    2.755731361800682e-06,
    -2.505074721511145e-08,
    1.5896197403776834e-10,
)
COSINE = (
    0.041666666666666595,
    -0.001388888888887304,
    2.480158728884133e-05,
    -2.755731417621464e-07,
    2.087570041212872e-09,
    -1.1358513729362734e-11,
)


def sincos_body(w: AssemblyWriter, x: str) -> tuple[str, str]:
    """(sine, cosine) of the vector x; instructions are appended to w."""
    shifted = w.fused("fadd", w.fused("fmul", x, TWO_OVER_PI), ROUND)
    k = w.fused("fsub", shifted, ROUND)
    r = x
    for part in (P1, P2, P3):
        r = w.fused("fsub", r, w.fused("fmul", k, part))
    z = w.fused("fmul", r, r)
    sine = _with_sign_of(w, r, w.fused("fadd", r, w.fused("fmul", w.fused("fmul", r, z), _polynomial(w, z, SINE))))
    tail = w.fused("fsub", w.fused("fmul", z, _polynomial(w, z, COSINE)), 0.5)
    cosine = w.fused("fadd", w.fused("fmul", z, tail), 1.0)
    return _quadrant(w, shifted, sine, cosine)


def _with_sign_of(w: AssemblyWriter, r: str, sine: str) -> str:
    """sin r has the sign of r, also where r = -0: there r + r^3 S is -0 + 0."""
    integers = f"<{w.width} x i64>"
    sign = f"<{', '.join([f'i64 {-(2**63)}'] * w.width)}>"
    negative = w.do(f"and {integers} {w.do(f'bitcast {w.kind} {r} to {integers}')}, {sign}")
    signed = w.do(f"or {integers} {w.do(f'bitcast {w.kind} {sine} to {integers}')}, {negative}")
    return w.do(f"bitcast {integers} {signed} to {w.kind}")


def _polynomial(w: AssemblyWriter, z: str, coefficients: tuple[float, ...]) -> str:
    """Estrin's scheme for six coefficients: short chains."""
    pairs = [w.fused("fadd", w.fused("fmul", z, coefficients[i + 1]), coefficients[i]) for i in range(0, 6, 2)]
    square = w.fused("fmul", z, z)
    upper = w.fused("fadd", pairs[1], w.fused("fmul", square, pairs[2]))
    return w.fused("fadd", pairs[0], w.fused("fmul", square, upper))


def _quadrant(w: AssemblyWriter, shifted: str, sine: str, cosine: str) -> tuple[str, str]:
    """k mod 4 from the low bits: odd exchanges the two, 2 and 3 (for the cosine 1 and 2) turn the sign."""
    integers = f"<{w.width} x i64>"

    def constant(n: int) -> str:
        """A vector of one integer."""
        return f"<{', '.join([f'i64 {n}'] * w.width)}>"

    bits = w.do(f"bitcast {w.kind} {shifted} to {integers}")
    odd = w.do(f"icmp ne {integers} {w.do(f'and {integers} {bits}, {constant(1)}')}, {constant(0)}")
    results = []
    for q, even, other in ((bits, sine, cosine), (w.do(f"add {integers} {bits}, {constant(1)}"), cosine, sine)):
        chosen = w.do(f"select <{w.width} x i1> {odd}, {w.kind} {other}, {w.kind} {even}")
        sign = w.do(f"and {integers} {w.do(f'shl {integers} {q}, {constant(62)}')}, {constant(-(2**63))}")
        flipped = w.do(f"xor {integers} {w.do(f'bitcast {w.kind} {chosen} to {integers}')}, {sign}")
        results.append(w.do(f"bitcast {integers} {flipped} to {w.kind}"))
    return results[0], results[1]
