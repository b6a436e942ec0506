"""The vectors' sine and cosine against exact values."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from machine_code import NEEDS_MACHINE_CODE
from mpmath import mp

from substructures.compile import compile_program, sincos
from substructures.expr.graph import Graph
from substructures.expr.program import Program

pytestmark = NEEDS_MACHINE_CODE


@pytest.fixture
def kernel(collected: Callable[..., Program]) -> Any:
    g = Graph()
    x = g.symbol("x")
    return compile_program(collected(g, {}, sin=g.function("sin", x), cos=g.function("cos", x)), ["sin", "cos"])


def errors(kernel: Any, x: Any) -> dict[str, float]:
    """Largest error in units in the last place of the exact result."""
    found, worst = kernel.evaluate({"x": x}), {}
    assert np.isfinite(found["sin"]).all()
    assert np.isfinite(found["cos"]).all()
    with mp.workprec(200):
        for name, exact in (("sin", mp.sin), ("cos", mp.cos)):
            pairs = ((exact(mp.mpf(float(a))), float(b)) for a, b in zip(x, found[name], strict=True))
            worst[name] = max(float(abs(e - mp.mpf(b))) / float(np.spacing(abs(float(e)))) for e, b in pairs)
    return worst


@pytest.mark.parametrize(("limit", "bound"), [(1e-8, 1), (1.0, 1.5), (4.0, 1.5), (100.0, 1.5), (1e5, 2.5), (1e8, 2.5)])
def test_random_arguments(kernel: Any, limit: float, bound: float) -> None:
    x = np.random.default_rng(1).uniform(-limit, limit, 2000)
    assert max(errors(kernel, x).values()) < bound


def nearest(multiples: Any) -> Any:
    """The doubles next to k pi/2."""
    with mp.workprec(200):
        return np.array([float(mp.mpf(int(k)) * mp.pi / 2) for k in multiples])


def test_next_to_multiples_of_a_right_angle(kernel: Any) -> None:
    x = nearest([*range(1, 300), *np.random.default_rng(2).integers(1, 63_661, 500)])
    assert max(errors(kernel, np.concatenate([x, -x, np.nextafter(x, 0)])).values()) < 2.5


@pytest.mark.deep
def test_next_to_all_multiples_up_to_1e5(kernel: Any) -> None:
    assert max(errors(kernel, nearest(range(1, 63_662))).values()) < 2.5


def test_special_arguments(kernel: Any) -> None:
    found = kernel.evaluate({"x": np.array([0.0, np.inf, -np.inf, np.nan, 1e300, 5e-324, 0.5])})
    np.testing.assert_array_equal(found["sin"][1:4], [np.nan] * 3)
    np.testing.assert_array_equal(found["cos"][1:4], [np.nan] * 3)
    assert found["sin"][0] == 0
    assert found["cos"][0] == 1
    assert found["sin"][5] == 5e-324
    assert abs(found["sin"][4] - np.sin(1e300)) < 1e-15
    assert found["sin"][6] == pytest.approx(np.sin(0.5), rel=3e-16)


def test_constants_are_exact() -> None:
    """P1 and P2 have 33 bits, so that products with |k| < 2^20 are exact; the three add up to pi/2."""
    for part in (sincos.P1, sincos.P2):
        assert Fraction(part).numerator.bit_length() <= 33
    with mp.workprec(200):
        rest = mp.pi / 2 - mp.mpf(sincos.P1) - mp.mpf(sincos.P2) - mp.mpf(sincos.P3)
        assert abs(rest) < mp.mpf(2) ** -120


def test_sine_of_minus_zero(kernel: Any) -> None:
    found = kernel.evaluate({"x": np.array([-0.0, 0.0, -0.0, -5e-324])})
    assert list(np.signbit(found["sin"])) == [True, False, True, True]
    assert (found["cos"] == 1).all()


@pytest.mark.parametrize("far", "abc")
def test_an_angle_beyond_the_limit_beside_others(collected: Callable[..., Program], far: str) -> None:
    g, names = Graph(), "abc"
    kernel = compile_program(collected(g, {}, **{x: g.function("sin", g.symbol(x)) for x in names}), list(names))
    values = {x: np.array([0.5, -1e18, np.nan] if x == far else [0.5, 0.25, -3.0]) for x in names}
    found = kernel.evaluate(values)
    for x in names:
        np.testing.assert_array_max_ulp(found[x], np.sin(values[x]), 2)
