"""Equilibria and root loci of textbook systems."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from analysis_models import catalogue_model, random_model
from closed_trees import four_bar, resized
from in_depth import deep, seeds
from random_trees import Plain, model_of

from substructures import InvalidInput, Model, linearise
from substructures.analysis.stability.equilibria import equilibria
from substructures.analysis.stability.root_locus import root_locus
from substructures.quantities.numbers.evaluation import evaluate

SLIDE: Plain = {"name": "b", "parent": "base", "mass": 2, "joint": {"type": "prismatic", "coordinate": "s"}}


def slide(**changes: object) -> Plain:
    return {"name": "slide", "bodies": [SLIDE], **changes}


def test_all_four_of_the_double_pendulum() -> None:
    """Hanging, and three with at least one rod upright."""
    found = equilibria(catalogue_model("double-pendulum"))
    angles = {tuple(np.round(np.abs(e.q) / np.pi, 9)) for e in found.found}
    assert angles == {(0, 0), (0, 1), (1, 0), (1, 1)}
    assert len(found.found) == 4
    verdicts = {tuple(np.round(np.abs(e.q) / np.pi)): e.at.stability.verdict for e in found.found if e.at.stability}
    assert verdicts[0, 0] == "stable"
    assert list(verdicts.values()).count("unstable") == 3


def test_what_is_found_is_gone_through_by_itself() -> None:
    found = equilibria(catalogue_model("double-pendulum"))
    assert [*found] == [*found.found]
    assert (len(found), found[-1]) == (4, found.found[3])


@pytest.mark.parametrize("number", seeds(3, 5))
def test_forces_vanish_on_random_trees(number: int) -> None:
    """What is found is an equilibrium by the independent way over evaluate."""
    # the odd ones have springs: there are equilibria
    model = random_model(2 * number + 1, loads=0)
    found = equilibria(model, count=4).found
    assert found
    for e in found:
        forces = evaluate(model, ["forces"], q=e.q)["forces"]
        assert np.abs(forces).max() < 1e-8
        assert e.at.is_equilibrium


def test_starts_may_be_arrays_in_a_list() -> None:
    """As states found elsewhere are."""
    found = equilibria(catalogue_model("double-pendulum"), starts=[np.zeros(2), np.array([3.1, 0])], count=0)
    assert len(found.found) == 2
    with pytest.raises(InvalidInput, match="rectangular"):
        equilibria(catalogue_model("double-pendulum"), starts=[np.zeros(2), np.zeros(3)], count=0)


def test_a_coordinate_without_force_is_held() -> None:
    """The cart stays where it started; K is singular along it."""
    found = equilibria(catalogue_model("cart-pendulum"))
    assert found.held == ("x.q0",)
    assert len(found.found) == 2
    np.testing.assert_allclose(np.abs(found.found[0].free), [[1, 0]], atol=1e-12)


def test_a_force_that_nothing_balances_is_named() -> None:
    found = equilibria(model_of(slide(), (0, 0, -9.81)))
    assert found.found == ()
    assert "'x.s'" in found.message


def test_inputs_move_the_equilibrium() -> None:
    """sin q = tau/(m g l)."""
    found = equilibria(catalogue_model("simple-pendulum"), inputs={"tau.x.q1": 9.81 / 2})
    np.testing.assert_allclose([e.q[0] for e in found.found], [np.pi / 6, 5 * np.pi / 6], atol=1e-12)
    assert [e.verdict for e in found.found] == ["stable", "unstable"]


def test_faults_have_pointers() -> None:
    model = catalogue_model("double-pendulum")
    cases: list[tuple[Plain, str]] = [
        ({"starts": [[1]]}, "/starts"),
        ({"count": -1}, "/count"),
        ({"reach": 0}, "/reach"),
        ({"seed": -1}, "/seed"),
        ({"t": "now"}, "/t"),
        ({"inputs": {"tau.x.q1": "x.q1"}}, "/inputs/tau.x.q1"),
        ({"parameters": {"nothing": 1}}, "/parameters/nothing"),
    ]
    for request, pointer in cases:
        with pytest.raises(InvalidInput) as error:
            equilibria(model, **request)
        assert error.value.faults[0].pointer == pointer


def oscillator() -> Plain:
    joint = SLIDE["joint"] | {"stiffness": 8, "damping": "c"}
    return slide(bodies=[SLIDE | {"joint": joint}], parameters={"c": {"value": 1}})


def test_root_locus_of_a_damped_oscillator() -> None:
    """2 s'' + c s' + 8 s = 0: (-c +- sqrt(c^2 - 64))/4, on a circle of radius 2 up to c = 8, then on the axis."""
    values = np.linspace(0, 12, 49)
    found = root_locus(model_of(oscillator(), (0, 0, 0)), parameter="c", values=values.tolist(), q=[0])
    assert found.status == "finished"
    root = np.sqrt(values.astype(complex) ** 2 - 64)
    exact = np.stack([(-values + root) / 4, (-values - root) / 4], axis=1)
    np.testing.assert_allclose(np.sort_complex(found.eigenvalues), np.sort_complex(exact), atol=1e-6)
    assert found.stability[0] == "stable"
    assert set(found.stability[1:]) == {"asymptotically stable"}
    steps = np.abs(np.diff(found.eigenvalues, axis=0)).max()
    assert steps < 1.5


def test_a_locus_begins_at_the_equilibrium_near_its_start() -> None:
    """Upright, with sqrt(g/l) and -sqrt(g/l) for any mass."""
    model = catalogue_model("simple-pendulum")
    found = root_locus(model, "x.m", [1, 2], [3.0])
    np.testing.assert_allclose(found.q[:, 0], np.pi)
    assert found.stability == ("unstable", "unstable")


def test_an_equilibrium_without_linearisation_ends_the_locus() -> None:
    """The force sqrt(s'^2) has no derivative at rest; sqrt(s'^2) s' has, and is 0 beside the damper."""
    loads = [{"type": "joint", "coordinate": "s", "force": "-sqrt(s'^2)*s'"}]
    found = root_locus(model_of(oscillator() | {"loads": loads}, (0, 0, 0)), "c", [1, 2], [0])
    assert (found.status, found.stability) == ("finished", ("asymptotically stable",) * 2)
    loads = [{"type": "joint", "coordinate": "s", "force": "-sqrt(s'^2)"}]
    found = root_locus(model_of(oscillator() | {"loads": loads}, (0, 0, 0)), "c", [1, 2], [0])
    assert (found.status, len(found.values), found.stability) == ("failed", 0, ())
    assert found.message == "there is no equilibrium near 'q' at c = 1: give another 'q'"


def test_a_lost_equilibrium_ends_the_locus() -> None:
    definition = oscillator()
    definition["parameters"]["k"] = {"value": 8}
    definition["bodies"][0]["joint"] = definition["bodies"][0]["joint"] | {"stiffness": "k"}
    model = model_of(definition, (0, 0, -1))
    found = root_locus(model, parameter="k", values=[8, 4, 0], q=[0])
    assert found.status == "failed"
    assert len(found.values) == 2
    assert "k = 0" in found.message
    with pytest.raises(InvalidInput, match="unknown parameter 'nothing'"):
        root_locus(model, parameter="nothing", values=[1], q=[0])


def test_faults_of_a_root_locus_have_pointers() -> None:
    model = model_of(oscillator(), (0, 0, 0))
    given: Plain = {"parameter": "c", "values": [1], "q": [0]}
    cases: list[tuple[Plain, str]] = [
        ({"parameter": "nothing"}, "/parameter"),
        ({"values": []}, "/values"),
        ({"values": [1, "x"]}, "/values/1"),
        ({"q": [0, 0]}, "/q"),
        ({"q": {"x.z": 0}}, "/q/x.z"),
        ({"inputs": {"tau.nobody": 1}}, "/inputs/tau.nobody"),
    ]
    for change, pointer in cases:
        with pytest.raises(InvalidInput) as error:
            root_locus(model, **given | change)
        assert error.value.faults[0].pointer == pointer
    assert all(root_locus(model, "c", [1], q).status == "finished" for q in ({"x.s": 0}, [0], 0))


def test_shown_in_two_lines() -> None:
    found = equilibria(catalogue_model("double-pendulum"))
    assert repr(found) == "Equilibria(found=4, held=[])\n3 unstable, 1 stable"
    assert all(repr(e).count("\n") == 1 for e in found.found)
    locus = root_locus(model_of(oscillator(), (0, 0, 0)), "c", [0, 1], [0])
    assert repr(locus) == "RootLocus(values=2, branches=2)\nstable, then asymptotically stable"


@pytest.mark.parametrize("size", [1e-9, *deep(1e-4, 1e4)])
@pytest.mark.parametrize("make", [lambda: catalogue_model("acrobot"), lambda: four_bar((0, -9.81, 0))])
def test_equilibria_do_not_depend_on_the_unit_of_length(make: Callable[[], Model], size: float) -> None:
    model = make()
    found, other = (equilibria(model, parameters=resized(model, x), count=32) for x in (1.0, size))
    assert len(found.found) == len(other.found) == 4
    assert other.is_right is True
    for one, two in zip(found.found, other.found, strict=True):
        np.testing.assert_allclose(two.q, one.q, atol=1e-7)
        assert one.verdict == two.verdict


def test_a_locus_begins_at_the_equilibrium_near_its_start_on_either_side_of_a_full_turn() -> None:
    """-pi and pi are one place, upright; hanging is farther away."""
    model = catalogue_model("simple-pendulum")
    for start in (-np.pi, np.nextafter(np.pi, 4), 3 * np.pi):
        found = root_locus(model, "x.m", [1, 2], [start])
        assert found.stability == ("unstable", "unstable")
        np.testing.assert_allclose(np.abs(found.q), np.pi)


def test_an_equilibrium_that_meets_another_one_ends_the_locus() -> None:
    """V' = s (k - 2 s^2 + s^4) = 0: s^2 = 1 + sqrt(1 - k) up to the fold at k = 1, and s = 0 at every k."""
    loads = [{"type": "potential", "potential": "k*s^2/2 - h*s^4/(2*l^2) + h*s^6/(6*l^4)"}]
    numbers = {"k": {"value": 0, "unit": "N/m"}, "h": {"value": 1, "unit": "N/m"}, "l": {"value": 1, "unit": "m"}}
    model = model_of(
        {"name": "mass", "bodies": [SLIDE | {"mass": 1}], "loads": loads, "parameters": numbers}, (0, 0, 0)
    )
    for values in ([0.8, 0.99, 0.9999, 1.01, 1.05], [0.8, 1.2, 2]):
        found = root_locus(model, "k", values, [1.2])
        kept = [k for k in values if k < 1]
        assert (found.status, len(found.values)) == ("failed", len(kept))
        np.testing.assert_allclose(found.q[:, 0] ** 2, 1 + np.sqrt(1 - np.array(kept)), rtol=1e-6)


def test_a_locus_goes_on_where_a_body_leaves_a_stiff_support() -> None:
    """A mass on a stop of 10^6 N/m that is lifted by a soft spring: far away, but the only equilibrium there is."""
    loads = [{"type": "joint", "coordinate": "s", "force": "F + 10^6*(sqrt(s^2 + (1/10^9)^2) - s)/2 - s"}]
    numbers = {"F": {"value": 0}}
    model = model_of({"name": "mass", "bodies": [SLIDE], "loads": loads, "parameters": numbers}, (0, 0, 0))
    found = root_locus(model, "F", [-2, -1, 1, 2], [0])
    np.testing.assert_allclose(found.q[:, 0], [-2 / 1000001, -1 / 1000001, 1, 2], rtol=1e-5)


def test_few_starts_hold_no_coordinate_that_forces_depend_on() -> None:
    """In horizontal gravity the torque of a pendulum is stationary at zero, where the search alone begins."""
    model = catalogue_model("simple-pendulum", ("9.81", 0, 0))
    found = equilibria(model, count=0)
    assert (found.held, found.found) == ((), ())
    assert "no equilibrium was found" in found.message


def test_a_small_pendulum_is_as_determined_as_a_large_one() -> None:
    """m g l = 1e-10 N m: K is small, M^-1 K = g/l is not."""
    found = equilibria(catalogue_model("simple-pendulum", m="1e-8", l="0.001"))
    assert [len(e.free) for e in found.found] == [0, 0]


@pytest.mark.parametrize("sign", [-1, 1])
def test_gravity_along_an_axis_in_decimals_holds_nothing(sign: int) -> None:
    """A pendulum about the vertical, in a world that is turned: K is rounding, neither restoring nor repelling."""
    axis = np.array([0.1, 0.2, 0.3])
    joint = {"type": "revolute", "coordinate": "a", "placement": {"position": [0, 0, 0]}, "axis": axis.tolist()}
    body = {"name": "b", "parent": "base", "mass": 1, "com": [0.3, 0.4, 0.5], "joint": joint}
    gravity = sign * 9.81 * axis / np.linalg.norm(axis)
    model = model_of({"name": "door", "bodies": [body]}, tuple(gravity.tolist()))
    for q in (0.3, 1.0, 2.0):
        told = linearise(model, [q]).stability
        assert told is not None
        assert told.verdict == "undecided"
    found = equilibria(model)
    assert (found.held, len(found.found)) == (("x.a",), 1)


def test_what_hardly_draws_back_still_does() -> None:
    """1 kg on 1e-14 N/m."""
    joint: Plain = {"type": "prismatic", "coordinate": "s", "stiffness": "1/10^14"}
    model = model_of({"name": "slide", "bodies": [SLIDE | {"mass": 1, "joint": joint}]}, (0, 0, 0))
    (found,) = equilibria(model).found
    assert (found.verdict, found.at.modes[0].frequency) == ("stable", pytest.approx(1e-7))
