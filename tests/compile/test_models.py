"""Compiled models of the whole catalogue beside the reference interpreter; unit: the last place of the terms."""

from __future__ import annotations

import dataclasses
import platform
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
from catalogue_entries import all_entries
from machine_code import NEEDS_MACHINE_CODE

from substructures import catalogue
from substructures.compile import compile_program, engine, target
from substructures.tree.model import Model

pytestmark = NEEDS_MACHINE_CODE

HUMANOID = tuple((i["name"], i["substructure"], i["at"]) for i in catalogue.load_tree("humanoid")["instances"])
COUPLED: dict[str, tuple[tuple[str, str, str], ...]] = {
    "arm-with-gripper": (("arm", "puma560", "world"), ("hand", "parallel-gripper", "arm.flange")),
    "arm-on-rail": (("rail", "linear-rail", "world"), ("arm", "ur5", "rail.carriage")),
    "two-arms": (("a", "planar-2r", "world"), ("b", "planar-2r", "a.flange"), ("c", "planar-3r", "world")),
}
TREES = {name: (("x", name, "world"),) for name in catalogue.names()} | COUPLED
#: of rounding errors that neither add up nor cancel; the interpreter has as many of its own
FEW = 4.0


def all_agree(model: Model, values: dict[str, Any], deviation: Callable[..., float]) -> float:
    kernel = compile_program(model.program, list(model.program.outputs))
    assert kernel.compiled
    found = kernel.evaluate(values)
    assert found.keys() == model.program.outputs.keys()
    return deviation(model.program, values, found)


@pytest.mark.parametrize("name", [*all_entries(), *COUPLED])
def test_catalogue(name: str, tree: Any, states: Any, deviation: Any) -> None:
    model = tree(*TREES[name])
    assert all_agree(model, states(model, 37), deviation) < FEW


@pytest.mark.parametrize("width", [2, 4, 8])
@pytest.mark.parametrize("name", ["puma560", "quadruped-leg", "two-arms"])
def test_vectors_of_other_hosts(name: str, width: int, tree: Any, states: Any, deviation: Any) -> None:
    model = tree(*TREES[name])
    values = states(model, 37)
    kernel = compile_program(model.program, list(model.program.outputs), width=width)
    assert deviation(model.program, values, kernel.evaluate(values)) < FEW


@pytest.mark.parametrize("name", ["acrobot", "ur5", "kuka-iiwa-14", "two-arms"])
def test_one_state_at_a_time_gives_the_bits_of_vectors(name: str, tree: Any, states: Any) -> None:
    """By code that is made more quickly, which contracts the same products with the same sums."""
    model = tree(*TREES[name])
    values, names = states(model, 5), ["metric", "christoffel", "bias", "forces"]
    whole = compile_program(model.program, names).evaluate(values)
    single = compile_program(model.program, names, single=True)
    for k in range(5):
        one = single.evaluate({name: x[k : k + 1] if np.ndim(x) else x for name, x in values.items()})
        for name in names:
            np.testing.assert_array_equal(one[name][0], whole[name][k])


@pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="older CPUs of this family")
@pytest.mark.parametrize(("cpu", "needs"), [("x86-64", "+sse2"), ("haswell", "+fma"), ("skylake-avx512", "+avx512dq")])
def test_code_for_other_cpus(
    cpu: str, needs: str, tree: Any, states: Any, deviation: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without fused multiply-add, with it, and with vectors of eight."""
    here = target.host()
    if needs not in here.features.split(","):
        pytest.skip(f"this CPU cannot run code for {cpu}")
    width = {"x86-64": 2, "haswell": 4}.get(cpu, 8)
    monkeypatch.setattr(target, "host", lambda: dataclasses.replace(here, cpu=cpu, features="", width=width))
    monkeypatch.setattr(target, "machine", cache(target.new_machine))
    monkeypatch.setattr(engine, "_runtimes", {})
    model = tree(*TREES["puma560"])
    assert all_agree(model, states(model, 37), deviation) < FEW


# takes seconds: the largest program that is compiled here, of 34 degrees of freedom, is LLVM's work
def test_humanoid(tree: Any, states: Any, deviation: Any) -> None:
    model = tree(*HUMANOID)
    values = states(model, 70)
    names = ["metric", "forces", "christoffel"]
    kernel = compile_program(model.program, names)
    found = kernel.evaluate(values)
    assert deviation(model.program, values, found) < FEW
    threaded = kernel.evaluate(states(model, 1030), threads=2)
    whole = kernel.evaluate(states(model, 1030))
    for name in names:
        np.testing.assert_array_equal(threaded[name], whole[name])


def test_a_state_that_is_not_finite(tree: Any, states: Any) -> None:
    model = tree(("x", "puma560", "world"))
    values = states(model, 9)
    values[model.coordinates[1]][4] = np.inf
    values[model.coordinates[2]][6] = np.nan
    found = compile_program(model.program, ["metric"]).evaluate(values)["metric"]
    finite = np.isfinite(found).all(axis=(1, 2))
    np.testing.assert_array_equal(np.flatnonzero(~finite), [4, 6])


@pytest.mark.deep
@pytest.mark.parametrize("name", TREES)
def test_many_states_of_the_catalogue(name: str, tree: Any, states: Any, deviation: Any) -> None:
    """Over all entries 10^5 states and more."""
    model = tree(*TREES[name])
    for seed in range(10):
        assert all_agree(model, states(model, 230, seed + 1), deviation) < FEW
