"""C++ over other scalars than double: constants are of their precision, and dual numbers are differentiated through."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest
from exported_models import exported_of, tree_of, write
from mixed_program import mixed_program
from run_code import alone, tool

from substructures import evaluate

CPP = ["-std=c++17", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wdouble-promotion", "-Werror"]
Q = (0.3, -0.7)

FLOATS = """
#include "arm.hpp"
#include "mixed.hpp"
#include <cstdio>
int main() {
    const std::array<float, 5> p{0.25F, 2, 3, 4, 0.5F};
    const auto all = mixed::any_<float>({}, {}, {}, {}, p);
    const auto g = arm::metric<float>({0.3F, -0.7F});
    std::printf("%.9g %.9g\\n", double(all.powers[2]), double(all.energy));
    for (float x : g) std::printf("%.9g ", double(x));
}
"""

#: a + b e with e^2 = 0; nothing but what the header asks for
DUALS = """
#include "arm.hpp"
#include <cstdio>
struct Dual {
    double a, b;
    Dual(double a_ = 0, double b_ = 0) : a(a_), b(b_) {}
};
Dual operator-(const Dual& x) { return {-x.a, -x.b}; }
Dual operator+(const Dual& x, const Dual& y) { return {x.a + y.a, x.b + y.b}; }
Dual operator-(const Dual& x, const Dual& y) { return {x.a - y.a, x.b - y.b}; }
Dual operator*(const Dual& x, const Dual& y) { return {x.a*y.a, x.a*y.b + x.b*y.a}; }
Dual cos(const Dual& x) { return {std::cos(x.a), -std::sin(x.a)*x.b}; }
Dual sin(const Dual& x) { return {std::sin(x.a), std::cos(x.a)*x.b}; }
int main() {
    for (const Dual& x : arm::metric<Dual>({Dual(0.3), Dual(-0.7, 1)})) std::printf("%.17g %.17g ", x.a, x.b);
}
"""


def printed(folder: Path, text: str) -> list[float]:
    """The numbers that a program prints."""
    (folder / "main.cpp").write_text(text)
    subprocess.run([tool("g++"), *CPP, "-o", "run", "main.cpp"], cwd=folder, check=True)
    return [float(x) for x in subprocess.run(["./run"], cwd=folder, check=True, capture_output=True).stdout.split()]


def test_floats_meet_no_double(tmp_path: Path) -> None:
    model = tree_of("acrobot")
    for exported in (alone(mixed_program(), "mixed"), exported_of(model, "arm", ["metric"])):
        write(exported, "cpp", tmp_path)
    power, energy, *g = printed(tmp_path, FLOATS)
    assert (power, energy) == (8, 0.5 * 4 * 2**2)
    exact = evaluate(model, ["metric"], Q)["metric"]
    assert g == pytest.approx(np.ravel(exact).tolist(), rel=1e-6)


def test_dual_numbers_have_the_derivatives(tmp_path: Path) -> None:
    model = tree_of("acrobot")
    write(exported_of(model, "arm", ["metric"]), "cpp", tmp_path)
    found = np.reshape(printed(tmp_path, DUALS), (2, 2, 2))
    exact = evaluate(model, ["metric", "christoffel"], Q)
    g, first = np.array(exact["metric"]), np.array(exact["christoffel"])
    assert found[..., 0] == pytest.approx(g, rel=1e-14)
    # d g_ab / d q^c = Gamma_abc + Gamma_bac
    assert found[..., 1] == pytest.approx((first + first.swapaxes(0, 1))[..., 1], rel=1e-13, abs=1e-15)
