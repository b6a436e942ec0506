"""FMUs with contacts: simulated by FMPy they hit, stick, slip and lift off where our own simulations do."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from closed_trees import tree_model
from contact_models import BALL, FREE, PLACED, G, block, box, disc, of, on_moving_plate, point
from run_code import require_clean_sources

from substructures import Model, couple, derive, simulate
from substructures.analysis.motion.contacts.exporting import contact_programs
from substructures.analysis.motion.problems.contacts import contacts_of
from substructures.errors import TooLarge
from substructures.export import Exported, exported_model, files, interface_of_model
from substructures.export.contacts import CONTACTS
from substructures.quantities.sources import Sources

fmpy = pytest.importorskip("fmpy", reason="the wheel FMPy is not installed")
from fmpy.validation import validate_fmu  # noqa: E402

from .fmu_instances import instance  # noqa: E402

TARGETS = {"3.0": "fmu", "2.0": "fmu2"}
FLOATING = {"type": "floating"}
CORNERS = ("c00", "c01", "c10", "c11")
KINDS = ("ModelExchange", "CoSimulation")
IMPACTS = ("contact.impacts", "contact.impact_energy", "contact.last_impact")


def exported_of(model: Model) -> Exported:
    interface = interface_of_model(model, "demo", "sha256:1")
    names = (CONTACTS, "forward_dynamics", "kinetic_energy", "potential_energy")
    names += ("position_rates",) if model.balls else ()
    made = exported_model(
        Sources(model), interface, names, "demo", packed=True, others=contact_programs(model, CONTACTS)
    )
    return replace(made, contacts=contacts_of(model))


def feet(friction: str) -> list[dict[str, str]]:
    return [{"name": c, "point": f"b.{c}", "type": "point_line", "friction": friction} for c in "lr"]


def bouncing() -> Model:
    return of("b", BALL, [0, 0, -G], contacts=[{"name": "floor", "point": "b.body", "restitution": "0.8"}])


def hopping() -> Model:
    contact = {"name": "foot", "point": "h.foot", "type": "point_line", "friction": "0.7"}
    tree = {"name": "hop", "gravity": [0, 0, "-9.81"], "instances": [{"name": "h", "substructure": "planar-hopper"}]}
    return couple({**tree, "contacts": [contact]}, {"h": derive("planar-hopper")})


def shaken() -> Model:
    """A ball on a plate whose motion is given: it lifts off by itself and comes down again."""
    slide = {"type": "prismatic", "coordinate": "s", "axis": [0, 0, 1], **PLACED}
    plate = {"name": "floor", "bodies": [{"name": "plate", "parent": "base", "joint": slide, "mass": 1}]}
    contact = {"name": "plate", "point": "b.body", "plane": "f.plate", "restitution": "0.5"}
    instances = [{"name": "f", "substructure": "floor"}, {"name": "b", "substructure": "ball"}]
    tree = {"gravity": [0, 0, -G], "instances": instances, "driven": {"f.s": "0.05*sin(20*t)"}, "contacts": [contact]}
    return tree_model(tree, {"floor": plate, "ball": BALL})


def thrown() -> Model:
    """A mass on a slope that holds it: it bounces, slides along a curve, and stops."""
    floor = {"name": "floor", "point": "b.body", "restitution": "0.5", "friction": "0.4"}
    return of("b", point(), [G * math.sin(0.2), 0, -G * math.cos(0.2)], contacts=[floor])


def carried() -> Model:
    """A mass on a plate that is shaken on a slant: it slips along a curve, sticks, breaks away, and sticks again."""
    return on_moving_plate("0.04*sin(8*t)", "0.03*sin(8*t)")


def corners(friction: str, restitution: str = "0", joint: dict[str, Any] = FREE) -> Model:
    """A box in space with four corners below."""
    law = {"friction": friction, "restitution": restitution}
    return of("b", box(joint), [0, 0, -G], contacts=[{"name": c, "point": f"b.{c}", **law} for c in CORNERS])


def rim(friction: str) -> Model:
    """A disc in space with eight points below, of which all are alike."""
    contacts = [{"name": f"p{k}", "point": f"b.p{k}", "friction": friction} for k in range(8)]
    return of("b", disc(8), [0, 0, -G], contacts=contacts)


def tilted(turn: float, width: float, height: float) -> list[float]:
    """A block on its right lower corner."""
    radius, alpha = math.hypot(width, height), math.atan2(width, height)
    return [radius * math.sin(alpha) - radius * math.sin(alpha - turn), radius * math.cos(alpha - turn), turn]


#: model, q, q', end, and how near states are: by our own steps, and by those of FMPy
MOTIONS: dict[str, tuple[Any, list[float], list[float], float, float]] = {
    "ball": (bouncing, [1], [0], 3, 1e-7),
    "rocking": (
        lambda: of("b", block(0.2, 0.5), [0, 0, -G], contacts=feet("2")),
        tilted(0.2, 0.2, 0.5),
        [0] * 3,
        2,
        1e-5,
    ),
    "sliding": (
        lambda: of("b", block(0.2, 0.1), [0, 0, -G], contacts=feet("0.3")),
        [0, 0.3, 0.2],
        [1, 0, 0],
        0.6,
        1e-7,
    ),
    "shaken": (shaken, [0], [1], 0.6, 1e-6),
    "hopper": (hopping, [0, 1, 0, 0.1, 0], [0.3, 0, 0, 0, 0], 1.5, 1e-6),
    "thrown": (thrown, [0, 0, 0.3], [-1, 1.5, 0], 2.5, 1e-7),
    "carried": (carried, [0, 0, 0.01], [0.8, -0.2, 0], 0.58, 1e-6),
    # four forces that are not unique; where a corner passes its own centre of slip its way turns at once
    "spun": (lambda: corners("0.3"), [0, 0, 0.15, 0, 0, 0], [1, 0.5, 0, 4, 0, 0], 0.8, 1e-7),
    "falling": (lambda: corners("0.3", "0.3"), [0, 0, 0.3, 0.3, 0.2, 0.4], [1, 0.5, 0, 0, 0, 0], 0.32, 1e-6),
    "ring": (lambda: rim("0.4"), [0, 0, 0.1, 0, 0, 0], [0.4, 0, 0, 0, 0, 0], 0.3, 1e-7),
    # by quaternions
    "turning": (
        lambda: corners("0.3", "0.3", FLOATING),
        [0, 0, 0.3, 0.9, 0.1, 0.3, 0.3],
        [1, 0.5, 0, 1, -2, 0.5],
        0.36,
        1e-6,
    ),
    "quaternions": (
        lambda: corners("0.3", "0", FLOATING),
        [0, 0, 0.15, 0.8, 0, 0, 0.6],
        [1, 0.5, 0, 0, 0, 4],
        0.8,
        1e-7,
    ),
    # a corner begins below its plane, by less than what is refused
    "below": (
        lambda: corners("0.8", "0", FLOATING),
        [0, 0, 0.126923349709, 0.98226180623, 0.150346194831, 0.100230796554, 0.050115398277],
        [0] * 6,
        0.25,
        1e-7,
    ),
    "rolling": (lambda: corners("0.8"), [0, 0, 0.3, 0.3, 0.2, 0.4], [1, 0.5, 0, 0, 0, 0], 0.53, 1e-6),
}


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Any:
    folder, found = tmp_path_factory.mktemp("fmu"), dict[tuple[str, str], tuple[Model, Path]]()

    def get(name: str, version: str) -> tuple[Model, Path]:
        if (name, version) not in found:
            model, path = MOTIONS[name][0](), folder / f"{name}{version[0]}.fmu"
            path.write_bytes(files(exported_of(model), TARGETS[version], 10**6)["demo.fmu"])
            found[name, version] = model, path
        return found[name, version]

    return get


@pytest.mark.parametrize("version", TARGETS)
@pytest.mark.parametrize("name", MOTIONS)
def test_it_moves_as_here(made: Any, name: str, version: str) -> None:
    """States at all times, the number and the energy of the impacts, and the time of the last one."""
    model, path = made(name, version)
    _, q, qd, end, near = MOTIONS[name]
    assert validate_fmu(str(path)) == []
    start = dict(zip(model.positions, q, strict=True))
    start |= {f"{c}_d" if c in model.positions else c: x for c, x in zip(model.coordinates, qd, strict=True)}
    ours = simulate(model, q, (0, end), qd=qd)
    hits = [event for event in ours.events if event.kind == "impact"]
    assert ours.is_right
    expected = np.hstack([ours.q, ours.qd])
    for kind in KINDS:
        found = fmpy.simulate_fmu(
            str(path), fmi_type=kind, start_values=start, stop_time=end, output_interval=end / 100,
            relative_tolerance=1e-10, output=[*start, *IMPACTS, "kinetic_energy", "potential_energy"],
        )  # fmt: skip
        at = [np.flatnonzero(np.abs(found["time"] - t) < 1e-9)[-1] for t in ours.t]
        shown = np.stack([found[each][at] for each in start], axis=1)
        first = int(name == "below")  # here it is lifted before the first result, there behind it
        assert np.abs(shown - expected)[first:].max() <= (near if kind == "ModelExchange" else 5e-8)
        count, energy, last = (found[name][-1] for name in IMPACTS)
        assert count == len(hits)
        assert energy == pytest.approx(sum(hit.energy_change for hit in hits), rel=1e-6)
        assert last == pytest.approx(hits[-1].t, abs=5e-6 if name == "thrown" else 1e-6)
        if name == "ball":
            # nothing else takes energy
            whole = found["kinetic_energy"] + found["potential_energy"] - found["contact.impact_energy"]
            assert np.ptp(whole) <= 1e-7 * whole[0]


@pytest.mark.parametrize("kind", KINDS)
def test_each_impact_is_when_it_is(made: Any, kind: str) -> None:
    """t_k = sqrt(2 h/g) (1 + 2 (e + e^2 + ...)), and 1 - e^2 of the energy is gone each time."""
    _, path = made("ball", "3.0")
    found = fmpy.simulate_fmu(
        str(path), fmi_type=kind, start_values={"b.z": 1.0}, stop_time=3.0, output_interval=0.05,
        relative_tolerance=1e-10, output=IMPACTS,
    )  # fmt: skip
    times = np.unique(found["contact.last_impact"])[1:]
    expected = math.sqrt(2 / G) * (1 + 2 * np.cumsum(0.8 ** np.arange(6)) - 2)
    np.testing.assert_allclose(times, expected, rtol=0, atol=1e-6)
    np.testing.assert_allclose(found["contact.impact_energy"][-1], -2 * G * (1 - 0.8**12), rtol=1e-6)


def test_a_rocking_block_comes_to_rest(made: Any) -> None:
    """Impacts accumulate, and it stands on both corners."""
    model, path = made("rocking", "3.0")
    start = dict(zip(model.coordinates, MOTIONS["rocking"][1], strict=True))
    for kind in KINDS:
        found = fmpy.simulate_fmu(
            str(path), fmi_type=kind, start_values=start, stop_time=4.0, output_interval=0.04,
            relative_tolerance=1e-10,
            output=["b.z", "b.phi", "b.phi_d", "contact.l.normal_force", "contact.r.normal_force"],
        )  # fmt: skip
        z, phi, rate, *forces = list(found[-1])[1:]
        assert np.abs([z - 0.5, phi, rate]).max() <= 1e-5
        assert forces == pytest.approx([G, G], rel=1e-4)


def test_states_are_kept_with_what_contacts_do(made: Any) -> None:
    model, path = made("sliding", "3.0")
    _, q, qd, *_ = MOTIONS["sliding"]
    start = dict(zip([*model.coordinates, *(f"{c}_d" for c in model.coordinates)], [*q, *qd], strict=True))
    names = [*start, *IMPACTS]
    with instance(path, **start) as (one, at):
        one.doStep(0.0, 0.2)
        kept = one.getFMUState()
        one.doStep(0.2, 0.4)
        first = one.getFloat64([at[s] for s in names])
        one.setFMUState(one.deserializeFMUState(one.serializeFMUState(kept)))
        one.doStep(0.2, 0.4)
        assert one.getFloat64([at[s] for s in names]) == first
        one.freeFMUState(kept)
        with pytest.raises(Exception, match="fmi3SetFloat64"):
            one.setFloat64([at["contact.impacts"]], [1.0])
        with pytest.raises(Exception, match="fmi3GetDirectionalDerivative"):
            one.getDirectionalDerivative([at["der(b.z_d)"]], [at["b.z"]], [1.0], 1)


def test_fixed_steps_end_at_impacts_too(made: Any) -> None:
    _, path = made("ball", "3.0")
    with instance(path, **{"b.z": 1.0, "solver_step": 0.01}) as (one, at):
        one.doStep(0.0, 1.0)
        z, last = one.getFloat64([at["b.z"], at["contact.last_impact"]])
    fall = math.sqrt(2 / G)
    assert last == pytest.approx(fall, abs=1e-9)
    assert z == pytest.approx(0.8 * G * fall * (1 - fall) - G / 2 * (1 - fall) ** 2, abs=1e-9)


def test_a_start_below_the_plane_is_refused(made: Any) -> None:
    _, path = made("ball", "3.0")
    with instance(path, **{"b.z": -1.0}) as (one, _), pytest.raises(Exception, match="fmi3DoStep"):
        one.doStep(0.0, 0.1)


@pytest.mark.parametrize("kind", KINDS)
def test_what_slides_on_a_slope_stops_where_it_is_held(made: Any, kind: str) -> None:
    """Friction against the way of slip is mu N; at rest it is the weight along the slope, and there is none across."""
    _, path = made("thrown", "3.0")
    forces = [f"contact.floor.{name}" for name in ("normal_force", "friction_force", "friction_force_y")]
    start = {"b.z": 0.0, "b.x_d": -1.0, "b.y_d": 1.5}
    found = fmpy.simulate_fmu(
        str(path), fmi_type=kind, start_values=start, stop_time=1.0, output_interval=0.01, relative_tolerance=1e-10,
        output=[*start, *forces],
    )  # fmt: skip
    found = found[1:]  # at first an importer asks before anything is decided
    normal, across, along = (found[name] for name in forces)
    weight = 2 * G
    assert normal == pytest.approx(np.full(len(normal), weight * math.cos(0.2)), rel=1e-9)
    speed = np.hypot(found["b.x_d"], found["b.y_d"])
    slides = speed > 1e-3
    ways = np.stack([found["b.x_d"], found["b.y_d"]])[:, slides] / speed[slides]
    shown = np.stack([across, along])[:, slides]
    assert slides.sum() > 20
    np.testing.assert_allclose(shown, -0.4 * normal[slides] * np.asarray(ways), rtol=0, atol=1e-6 * weight)
    assert speed[-1] <= 1e-9
    assert [across[-1], along[-1]] == pytest.approx([-weight * math.sin(0.2), 0], abs=1e-9 * weight)


def test_what_an_fmu_does_not_follow_is_refused() -> None:
    many = [{"name": f"c{i}", "point": "b.body"} for i in range(17)]
    with pytest.raises(TooLarge, match="contacts of an FMU"):
        files(exported_of(of("b", BALL, [0, 0, -G], contacts=many)), "fmu", 10**6)


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("version", TARGETS)
@pytest.mark.parametrize("name", ["spun", "turning"])
def test_the_sources_compile_without_a_warning(
    made: Any, name: str, version: str, compiler: str, tmp_path: Path
) -> None:
    require_clean_sources(made(name, version)[1], compiler, tmp_path)
