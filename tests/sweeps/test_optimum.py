"""Best parameters: known answers, exact balancing by springs, costs with corners, and what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from substructures import Model, couple, derive
from substructures.documents import read_model
from substructures.errors import InvalidInput
from substructures.quantities.sources import Sources, of_parts
from substructures.sweeps.document import SweepDocument
from substructures.sweeps.optimum import Aim, optimal_parameters
from substructures.tree.document import TreeSpec
from tests.sweeps.test_analyses import ROD

#: a rod of length l and mass m at its end, and a spring without length at rest from a point b above its hinge to a
#: point a along it: balanced everywhere where k = m g l/(a b)
BALANCED: dict[str, Any] = {
    "name": "lamp",
    "gravity": [0, 0, "-g"],
    "parameters": {name: {"value": x} for name, x in {"g": 9.81, "k": 100, "b": 0.3}.items()},
    "instances": [{"name": "a", "substructure": "rod", "parameters": {"c": 0}}],
    "loads": [
        {
            "type": "spring",
            "name": "spring",
            "stiffness": "k",
            "length": 0,
            "from": "world",
            "from_at": [0, 0, "b"],
            "to": "a.rod",
            "to_at": [0.2, 0, 0],
        }
    ],
}


def sources_of(tree: dict[str, Any], part: dict[str, Any]) -> Sources:
    spec, parts = TreeSpec.read(tree), {"a": derive(part)}
    model: Model = couple(spec, parts)
    return Sources(model, of_parts=of_parts(spec, parts))


def aim(minimise: str, vary: dict[str, Any], columns: dict[str, Any], **more: Any) -> Aim:
    document = {"template": {}, "columns": columns}
    return Aim(minimise, vary, read_model(SweepDocument, document).columns, **more)


@pytest.fixture(scope="module")
def rod() -> Sources:
    tree = {"name": "t", "gravity": [0, 0, -9.81], "instances": [{"name": "a", "substructure": "rod"}]}
    return sources_of(tree, ROD)


def test_a_frequency_is_placed(rod: Sources) -> None:
    """w^2 = (c - m g l sin q)/(m l^2) about q = -pi/2 is 16: c = 16 m - 9.81 m."""
    columns = {"w": {"analysis": "linearisation", "at": {"q": [-np.pi / 2]}, "held": True}}
    found = optimal_parameters(rod, aim("(w - 4)^2", {"a.c": (0, 40)}, columns), {"a.m": 2})
    assert found.is_right, found
    assert found.parameters["a.c"] == pytest.approx(16 * 2 - 9.81 * 2, rel=1e-6)
    assert found.value < 1e-12


def test_springs_balance_exactly() -> None:
    poses = np.linspace(-1.2, 1.4, 9)[:, None].tolist()
    columns = {"force": {"quantity": "forces", "over": {"q": poses}, "take": "rms"}}
    sources = sources_of(BALANCED, ROD)
    found = optimal_parameters(sources, aim("force", {"k": (10, 1000), "b": (0.1, 0.6)}, columns))
    assert found.is_right
    assert found.value < 1e-6 * 2 * 9.81
    assert found.parameters["k"] * found.parameters["b"] == pytest.approx(2 * 9.81 / 0.2, rel=1e-6)


def test_the_largest_of_several_has_a_corner(rod: Sources) -> None:
    """max(x, 1 - x) of two torques is least where they are equal."""
    columns = {
        "one": {"quantity": "inverse_dynamics", "over": {"q": [0], "qdd": [1]}},
        "two": "60 - one",
    }
    found = optimal_parameters(rod, aim("max(one, two)", {"a.m": (0.5, 5)}, columns))
    assert found.is_right
    assert found.value == pytest.approx(30, rel=1e-7)  # m (1 + 9.81) = 30
    assert found.parameters["a.m"] == pytest.approx(30 / 10.81, rel=1e-6)


def test_a_corner_at_zero_is_right(rod: Sources) -> None:
    """Nothing is small beside a least cost of 0, which rounding misses."""
    found = optimal_parameters(rod, aim("abs(mass - 1.7)*abs(mass - 2.9)", {"a.m": (1, 5)}, {"mass": "mass"}, starts=1))
    assert 0 < found.value < 1e-8
    assert found.is_right


def test_conditions_hold_and_are_told(rod: Sources) -> None:
    columns = {"mass": "mass", "reach": {"analysis": "reach", "of": "a.tip"}}
    found = optimal_parameters(
        rod, aim("mass + (a.l - 3)^2", {"a.m": (1, 5), "a.l": (0.2, 4)}, columns, where="reach < 1.5 and mass >= 2")
    )
    assert found.is_right
    assert found.parameters == pytest.approx({"a.m": 2, "a.l": 1.5}, rel=1e-6)
    assert found.value == pytest.approx(4.25, rel=1e-6)
    assert found.active == ("reach < 1.5", "mass >= 2")


def test_motions_are_costs(rod: Sources) -> None:
    """The damping that makes int q'^2 over a second least is the largest."""
    motion = {"analysis": "simulation", "at": {"q": [0]}, "span": [0, 1], "expression": "a.q'^2", "take": "integral"}
    found = optimal_parameters(rod, aim("spent", {"a.d": (0, 3)}, {"spent": motion}, starts=2))
    assert found.is_right
    assert found.parameters["a.d"] == 3
    assert found.active == ("a.d <= 3",)


def test_a_cost_without_a_least_value_is_not_right(rod: Sources) -> None:
    """It falls without end towards a pole."""
    found = optimal_parameters(rod, aim("1/(mass - 1.7)", {"a.m": (1, 5)}, {"mass": "mass"}, starts=1))
    assert found.is_right is False
    assert found.value < -1e6


def test_nothing_may_hold(rod: Sources) -> None:
    found = optimal_parameters(rod, aim("mass", {"a.m": (1, 2)}, {"mass": "mass"}, where="mass > 3"))
    assert (found.status, found.is_right) == ("failed", None)
    assert "widen the bounds" in found.message


def test_it_is_the_same_again_and_stops(rod: Sources) -> None:
    told: list[float] = []
    wanted = aim("(mass - 1.7)^2", {"a.m": (1, 5)}, {"mass": "mass"})
    one, two = (optimal_parameters(rod, wanted) for _ in range(2))
    assert one.parameters == two.parameters
    assert one.evaluations == two.evaluations
    stopped = optimal_parameters(rod, wanted, progress=lambda share: bool(told.append(share)))
    assert len(told) == 1
    assert np.isfinite(stopped.found).sum() == 1


def test_a_planted_fault_is_seen(rod: Sources, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without looking around, and with a search that stays where it begins."""
    monkeypatch.setattr("substructures.sweeps.optimum._Search._looked", lambda _, x: x)
    monkeypatch.setattr("substructures.sweeps.optimum._Search._solved", lambda _, x: x)
    found = optimal_parameters(rod, aim("(mass - 1.7)^2 + 1", {"a.m": (1, 5)}, {"mass": "mass"}))
    assert found.is_right is False


@pytest.mark.parametrize(
    ("given", "pointer", "code"),
    [
        ({"vary": {"a.x": (0, 1)}}, "/vary/a.x", "unknown-parameter"),
        ({"vary": {"a.m": (2, 1)}}, "/vary/a.m", "empty-range"),
        ({"minimise": "weight"}, "/minimise", "unknown-column"),
        ({"where": "mass < 1 or mass > 2"}, "/where", "not-supported"),
        ({"where": "mass == 1"}, "/where", "not-supported"),
        ({"columns": {"x": {"quantity": "metric"}}, "minimise": "y"}, "/minimise", "unknown-column"),
        ({"columns": {"x": {"quantity": "metric", "over": {"q": [0, 0]}}}, "minimise": "x"}, "/columns/x",
         "several-numbers"),
    ],
)  # fmt: skip
def test_bad_input(rod: Sources, given: dict[str, Any], pointer: str, code: str) -> None:
    wanted = {"minimise": "mass", "vary": {"a.m": (1, 2)}, "columns": {"mass": "mass"}} | given
    with pytest.raises(InvalidInput) as caught:
        optimal_parameters(rod, aim(**wanted))
    assert caught.value.faults[0].code == code, caught.value.faults
    assert caught.value.faults[0].pointer.startswith(pointer)
