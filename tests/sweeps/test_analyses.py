"""Columns of analyses: equilibria, reach and motions of rows against closed forms, and against one tree at a time."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy
from catalogue_entries import shipped_part

from substructures import couple, derive, evaluate, simulate
from substructures.errors import InvalidInput
from tests.sweeps.in_process import Sweep

ROD: dict[str, Any] = {
    "name": "rod",
    "parameters": {name: {"value": x} for name, x in {"l": 1, "m": 2, "c": 30, "d": 0}.items()},
    "bodies": [
        {
            "name": "rod",
            "parent": "base",
            "joint": {"type": "revolute", "coordinate": "q", "theta": "pi/2", "stiffness": "c", "damping": "d"},
            "mass": "m",
            "com": ["l", 0, 0],
        }
    ],
    "ports": [{"name": "tip", "body": "rod", "position": ["l", 0, 0]}],
}
ALONE = {"name": "t", "gravity": [0, 0, "-g"], "parameters": {"g": {"value": 9.81}}}
SPRUNG: dict[str, Any] = {
    "template": {**ALONE, "instances": [{"name": "a", "substructure": "rod"}]},
    "samples": {"method": "grid", "of": {"a.m": {"values": [0.5, 2, 3.5]}, "a.c": {"values": [25, 60]}}},
    "columns": {"mass": "mass"},
}
AT = {"q": [-0.3]}


def planar(count: int, **joints: Any) -> dict[str, Any]:
    """Rods in a plane, one behind the other, of lengths 1, 1/2, 1/3, ..."""
    bodies = [
        {
            "name": f"b{k}",
            "parent": f"b{k - 1}" if k else "base",
            "joint": {
                "type": "revolute",
                "coordinate": f"q{k}",
                **({"d": f"1/{k}"} if k else {}),
                **joints.get(f"q{k}", {}),
            },
            "mass": 1,
            "inertia": {"xx": 0.1, "yy": 0.1, "zz": 0.1},
        }
        for k in range(count)
    ]
    tip = {"name": "tip", "body": f"b{count - 1}", "position": [f"1/{count}", 0, 0]}
    return {"name": "planar", "bodies": bodies, "ports": [tip]}


def reach(part: dict[str, Any], **column: Any) -> float:
    template = {"name": "t", "instances": [{"name": "a", "substructure": "planar"}]}
    columns = {"r": {"analysis": "reach", "of": "a.tip", **column}}
    found = Sweep({"template": template, "columns": columns}, {"planar": part}).rows()
    return float(found.columns["r"][0])


def test_equilibria_are_roots_of_the_balance_of_moments() -> None:
    columns = {
        "q": {"analysis": "equilibrium", "at": AT, "of": "a.q"},
        "w": {"analysis": "linearisation", "at": AT, "settle": True},
    }
    found = Sweep(SPRUNG, {"rod": ROD}, columns=columns).rows().columns
    assert len(found["q"]) == 6
    for m, c, q, w in zip(found["a.m"], found["a.c"], found["q"], found["w"], strict=True):
        # c q + m g l cos q = 0
        hand = scipy.optimize.brentq(lambda x: c * x + m * 9.81 * np.cos(x), -1.5, 0)  # noqa: B023 -- called here
        assert q == pytest.approx(hand, rel=1e-12)
        assert w == pytest.approx(np.sqrt((c - m * 9.81 * np.sin(q)) / m), rel=1e-10)


def test_rows_without_equilibrium_have_no_number() -> None:
    rail = {**ROD, "bodies": [{**ROD["bodies"][0], "joint": {"type": "prismatic", "coordinate": "q"}}]}
    columns = {"q": {"analysis": "equilibrium", "at": AT, "of": "a.q"}}
    sweep = Sweep(SPRUNG, {"rod": rail}, columns=columns, template={**SPRUNG["template"], "gravity": [0, 0, -9.81]})
    assert not len(sweep.rows().rows)
    assert sweep.refusals.by_code["not-finite"]["rows"] == 6


def test_rows_that_do_not_settle_leave_the_others() -> None:
    """A mass of 2 kg on a spring, or on none; micromechanics, where the determinant of M underflows."""
    joint = {"type": "prismatic", "coordinate": "q", "stiffness": "c"}
    slide = {**ROD, "bodies": [{**ROD["bodies"][0], "joint": joint}]}
    template = {**SPRUNG["template"], "gravity": [0, 0, -9.81]}
    columns = {"w": {"analysis": "linearisation", "at": {"q": [0]}, "settle": True}}
    samples = {"method": "list", "of": {"a.c": {"values": [0, 8]}}}
    found = Sweep({"template": template, "samples": samples, "columns": columns}, {"rod": slide}).rows()
    assert (found.rows.tolist(), found.columns["w"]) == ([1], pytest.approx([2]))
    tiny = planar(40, **{f"q{k}": {"stiffness": 1e-9} for k in range(40)})
    for body in tiny["bodies"]:
        body["inertia"] = dict.fromkeys(("xx", "yy", "zz"), 1e-9)
        body["mass"] = 0
    template = {"name": "t", "instances": [{"name": "a", "substructure": "planar"}]}
    columns["w"] = {"analysis": "linearisation", "at": {"q": [0] * 40}, "take": "largest_real_part"}
    assert Sweep({"template": template, "columns": columns}, {"planar": tiny}).rows().columns["w"] == pytest.approx([0])


def test_masses_that_overflow_leave_the_others() -> None:
    for damping in (0, 1):
        joint = {"type": "prismatic", "coordinate": "q", "stiffness": "c", "damping": damping}
        slide = {**ROD, "bodies": [{**ROD["bodies"][0], "joint": joint}]}
        samples = {"method": "list", "of": {"a.m": {"values": [1e-310, 30]}}}
        columns = {"w": {"analysis": "linearisation", "at": {"q": [0.1]}, "held": True}}
        found = Sweep(SPRUNG, {"rod": slide}, samples=samples, columns=columns).rows()
        assert (found.rows.tolist(), found.columns["w"]) == ([1], pytest.approx([1]))


def test_what_does_not_move_is_told() -> None:
    still = {"name": "rod", "bodies": [{"name": "b", "parent": "base", "joint": {"type": "fixed"}, "mass": 1}]}
    template = {"name": "t", "instances": [{"name": "a", "substructure": "rod"}]}
    for column, code in (
        ({"analysis": "linearisation"}, "no-coordinates"),
        ({"quantity": "metric", "take": "largest"}, "no-numbers"),
    ):
        sweep = Sweep({"template": template, "columns": {"x": column}}, {"rod": still})
        assert not len(sweep.rows().rows)
        assert list(sweep.refusals.by_code) == [code]


def test_the_reach_of_rods_is_their_length() -> None:
    assert reach(planar(1)) == pytest.approx(1, rel=1e-12)
    assert reach(planar(4)) == pytest.approx(1 + 1 / 2 + 1 / 3 + 1 / 4, rel=1e-10)
    assert reach(planar(3), about="a.b1") == pytest.approx(1 / 2 + 1 / 3, rel=1e-10)


def test_reach_is_within_limits() -> None:
    bent = planar(2, q1={"limits": [0.5, 2.0]})
    # 1 + 1/4 + 2 1/2 cos 1/2, law of cosines
    assert reach(bent) == pytest.approx(np.sqrt(1.25 + np.cos(0.5)), rel=1e-12)
    turned = planar(2, q1={"limits": [7.0, 9.0]})  # from behind a full turn on
    assert reach(turned) == pytest.approx(np.sqrt(1.25 + np.cos(7.0)), rel=1e-12)


def test_reach_of_sliding_joints() -> None:
    out = planar(2, q1={"type": "prismatic", "limits": [-3, 1]})
    # the tip is 1/2 beside the second origin, which moves along z
    assert reach(out) == pytest.approx(np.hypot(1.5, 3), rel=1e-12)
    for size in (1e-7, 1e6):  # whatever the size: two rods on a carriage that moves across
        large = planar(3, q0={"type": "prismatic", "limits": [0, size]}, q1={"d": 0}, q2={"d": size})
        large["ports"][0]["position"] = [size, 0, 0]
        assert reach(large) == pytest.approx(np.sqrt(5) * size, rel=1e-12)
    free = planar(2, q1={"type": "prismatic"})
    sweep = Sweep(
        {
            "template": {"name": "t", "instances": [{"name": "a", "substructure": "planar"}]},
            "columns": {"r": {"analysis": "reach", "of": "a.tip"}},
        },
        {"planar": free},
    )
    assert not len(sweep.rows().rows)
    assert "has no limits" in sweep.refusals.by_code["no-limits"]["example"]["message"]


def test_reach_where_a_coordinate_moves_two_joints() -> None:
    follows = planar(3)
    follows["relations"] = [{"coordinate": "q2", "of": "q1", "multiplier": -0.5, "offset": 0.7}]
    grid = np.linspace(-np.pi, np.pi, 20001)
    far = np.abs(1 + np.exp(1j * grid) / 2 + np.exp(1j * (grid * 0.5 + 0.7)) / 3).max()
    assert reach(follows) == pytest.approx(far, rel=1e-3)


def test_no_pose_of_a_robot_is_further_than_its_reach() -> None:
    column = {"r": {"analysis": "reach", "of": "arm.flange"}}
    template = {"name": "t", "instances": [{"name": "arm", "substructure": "puma560"}]}
    samples = {"of": {"arm.a2": {"values": [0.2, 0.6]}}, "method": "grid"}
    sweep = Sweep({"template": template, "columns": column, "samples": samples})
    found = sweep.rows().columns["r"]
    for k, a2 in enumerate((0.2, 0.6)):
        model = couple(sweep.plan.tree(k), {"arm": derive("puma560")})
        q = np.random.default_rng(1).uniform(-np.pi, np.pi, (20_000, 6))
        place = evaluate(model, "kinematics", q)["kinematics"]["position"][:, model.frames.index("arm.flange")]
        assert np.linalg.norm(place, axis=1).max() <= found[k] * (1 + 1e-12), a2
    assert 0.35 < found[1] - found[0] <= 0.4


def test_reach_is_where_loops_close_within_their_limits() -> None:
    """Of 13,824 poses of a gripper four in five are none, or beyond the limits of joints that loops move."""
    template = {"name": "t", "instances": [{"name": "x", "substructure": "robotiq-2f85"}]}
    found = Sweep({"template": template, "columns": {"r": {"analysis": "reach", "of": "x.left_tip"}}}).rows()
    model = couple(template, {"x": shipped_part("robotiq-2f85")})
    judge = model.plausibility
    assert judge is not None
    limits = {name: [float(x) for x in row[:2]] for name, row in judge.limits_at_defaults.items()}
    axes = np.meshgrid(*(np.linspace(*limits[name], 24) for name in model.coordinates), indexing="ij")
    asked = evaluate(model, ["kinematics", "dependent"], np.stack([x.ravel() for x in axes], axis=1))
    inside = [  # not where a loop does not close
        (asked["dependent"][:, k] >= limits[name][0]) & (asked["dependent"][:, k] <= limits[name][1])
        for k, name in enumerate(model.dependent)
    ]
    place = asked["kinematics"]["position"][np.all(inside, axis=0), model.frames.index("x.left_tip")]
    assert 0.1 < len(place) / 24**3 < 0.9
    assert found.columns["r"] == pytest.approx(np.linalg.norm(place, axis=1).max(), rel=2e-3)


def test_motions_of_an_oscillator() -> None:
    slide = {**ROD, "bodies": [{**ROD["bodies"][0], "joint": {**ROD["bodies"][0]["joint"], "type": "prismatic"}}]}
    motion = {"analysis": "simulation", "at": {"q": [0.1]}, "span": [0, 2]}
    columns = {
        "end": {**motion, "expression": "a.q"},
        "power": {**motion, "expression": "a.q'^2", "take": "integral"},
        "energy": {**motion, "quantity": "kinetic_energy", "take": "largest", "count": 2001},
        "both": "end + power",
    }
    sweep = Sweep(SPRUNG, {"rod": slide}, columns=columns, template={**SPRUNG["template"], "gravity": [0, 0, 0]})
    found = sweep.rows().columns
    assert sweep.plan.columns.of_motions == {"end", "power", "energy", "both"}
    w = np.sqrt(found["a.c"] / found["a.m"])
    assert found["end"] == pytest.approx(0.1 * np.cos(2 * w), abs=1e-7)
    # of 0.01 w^2 sin^2(w t)
    assert found["power"] == pytest.approx(0.005 * w**2 * (2 - np.sin(4 * w) / (2 * w)), rel=1e-6)
    assert found["energy"] == pytest.approx(found["a.c"] * 0.005, rel=1e-4)


def test_tolerances_of_motions() -> None:
    """A coarse absolute tolerance is taken, so that motions that are stepped so violate their conditions."""
    motion = {"analysis": "simulation", "at": {"q": [0.1]}, "span": [0, 20], "expression": "a.q"}
    columns = {"fine": {**motion, "absolute_tolerance": 1e-14}, "coarse": {**motion, "absolute_tolerance": 0.1}}
    found = Sweep(SPRUNG, {"rod": ROD}, columns={**columns, "usual": motion}).rows().columns
    assert found["fine"] == pytest.approx(found["usual"], abs=1e-6)
    assert np.isnan(found["coarse"]).all()


def test_motions_with_contacts_are_those_of_each_row() -> None:
    """A ball bounces with 0.8 of its velocity, whatever its mass; a row that starts below has no number."""
    ball = {
        **ROD,
        "bodies": [{"name": "rod", "parent": "base", "joint": {"type": "prismatic", "coordinate": "q"}, "mass": "m"}],
    }
    contact = {"name": "floor", "point": "a.rod", "restitution": "0.8"}
    template = {**SPRUNG["template"], "contacts": [contact]}
    samples = {"method": "grid", "of": {"a.m": {"values": [0.5, 2]}, "g": {"values": [7, 9.81]}}}
    motion = {"analysis": "simulation", "at": {"q": [1]}, "span": [0, 1]}
    columns = {
        "end": {**motion, "expression": "a.q"},
        "weight": {"quantity": "gravity", "over": {"q": [[1]]}, "take": "smallest"},
    }
    sweep = Sweep(SPRUNG, {"rod": ball}, columns=columns, template=template, samples=samples)
    found = sweep.rows().columns
    fall = np.sqrt(2 / found["g"])
    left = 1 - fall
    assert found["end"] == pytest.approx(0.8 * found["g"] * fall * left - found["g"] / 2 * left**2, abs=1e-7)
    assert found["weight"] == pytest.approx(-found["a.m"] * found["g"])
    for row in range(4):
        values, _ = sweep.slow(row)
        assert values["end"] == pytest.approx(found["end"][row], rel=1e-9)
    still = Sweep(
        SPRUNG, {"rod": ball}, columns={"x": {"analysis": "equilibrium", "at": AT, "of": "a.q"}}, template=template
    )
    still.rows()
    assert list(still.refusals.by_code) == ["has-contacts"]
    below = Sweep(SPRUNG, {"rod": ball}, columns={"end": {**columns["end"], "at": {"q": [-1]}}}, template=template)
    assert np.isnan(below.rows().columns.get("end", np.nan)).all()


def test_motions_of_floating_bodies_have_contacts() -> None:
    """The same bounce, of a body that spins by quaternions."""
    body = {"name": "rod", "parent": "base", "joint": {"type": "floating"}, "mass": "m",
            "inertia": {"xx": 1, "yy": 2, "zz": 3}}  # fmt: skip
    template = {**SPRUNG["template"], "contacts": [{"name": "floor", "point": "a.rod", "restitution": "0.8"}]}
    start = {"q": [0, 0, 1, 1, 0, 0, 0], "qd": [0, 0, 0, 1, 2, 3]}
    columns = {"end": {"analysis": "simulation", "at": start, "span": [0, 1], "expression": "a.r_rod_z"}}
    sweep = Sweep(SPRUNG, {"rod": {**ROD, "bodies": [body]}}, columns=columns, template=template)
    found = sweep.rows().columns
    fall = np.sqrt(2 / 9.81)
    left = 1 - fall
    assert found["end"] == pytest.approx(0.8 * 9.81 * fall * left - 9.81 / 2 * left**2, abs=1e-7)


def test_motions_with_inputs_are_those_of_one_tree() -> None:
    drive = {"tau.a.q": "5*sin(3*t)"}
    motion = {"analysis": "simulation", "at": {"q": [0.4], "qd": [0.2], "inputs": drive}, "span": [0, 1]}
    columns = {
        "end": {**motion, "expression": "a.q"},
        "work": {**motion, "expression": "tau.a.q*a.q'", "take": "integral"},
    }
    sweep = Sweep(SPRUNG, {"rod": ROD}, columns=columns)
    found = sweep.rows()
    for row in (1, 4):
        model = couple(sweep.plan.tree(row), {"a": derive(ROD)})
        run = simulate(model, [0.4], (0, 1), qd=[0.2], inputs=drive)
        assert run.is_right
        assert found.columns["end"][row] == pytest.approx(run.q[-1, 0], rel=1e-6)
        m, c = found.columns["a.m"][row], found.columns["a.c"][row]
        q, qd = run.q[[0, -1], 0], run.qd[[0, -1], 0]
        energy = m * qd**2 / 2 + c * q**2 / 2 + m * 9.81 * np.sin(q)
        assert found.columns["work"][row] == pytest.approx(energy[1] - energy[0], rel=1e-6)


@pytest.mark.parametrize(
    ("column", "pointer", "code"),
    [
        ({"analysis": "equilibrium", "at": AT, "of": "a.p"}, "/columns/x/of", "unknown-coordinate"),
        ({"analysis": "equilibrium", "at": {"q": [0, 1]}, "of": "a.q"}, "/columns/x/at/q", "too-many-states"),
        ({"analysis": "equilibrium", "at": {"q": [0], "p": 1}, "of": "a.q"}, "/columns/x/at/p", "unknown-field"),
        ({"analysis": "linearisation", "at": {"q": [0], "qdd": [1]}}, "/columns/x/at/qdd", "unknown-field"),
        (
            {"analysis": "simulation", "at": {"q": [[0], [1]]}, "span": [0, 1], "expression": "a.q"},
            "/columns/x/at/q",
            "too-many-states",
        ),
        (  # as many as there are rows, which they are not of
            {
                "analysis": "simulation",
                "at": {**AT, "inputs": {"tau.a.q": [0, 1, 2, 3, 4, 5]}},
                "span": [0, 1],
                "expression": "a.q",
            },
            "/columns/x/at/q",
            "too-many-states",
        ),
        ({"quantity": "forces", "over": {"q": []}}, "/columns/x/over/q", "missing"),
        ({"quantity": "forces", "over": {**AT, "inputs": [1]}}, "/columns/x/over/inputs", "object-expected"),
        ({"quantity": "forces", "over": {**AT, "t": ["1 s"]}}, "/columns/x/over/t/0", "number-expected"),
        ({"analysis": "reach", "of": "a.top"}, "/columns/x/of", "unknown-name"),
        (
            {"analysis": "simulation", "at": {"p": 1}, "span": [0, 1], "expression": "a.q"},
            "/columns/x/at/p",
            "unknown-field",
        ),
        ({"analysis": "simulation", "at": AT, "span": [1, 0], "expression": "a.q"}, "/columns/x/span", "empty-span"),
        (
            {"analysis": "simulation", "at": AT, "span": [0, 1], "expression": "a.p"},
            "/columns/x/expression",
            "unknown-name",
        ),
    ],
)
def test_faults_have_their_place(column: Any, pointer: str, code: str) -> None:
    sweep = Sweep(SPRUNG, {"rod": ROD}, columns={"x": column})
    shape = sweep.rows  # told by row
    assert not len(shape().rows)
    ((found, told),) = sweep.refusals.by_code.items()
    assert (found, told["rows"]) == (code, 6)
    assert pointer in told["example"]["message"], told


@pytest.mark.parametrize(
    ("column", "code"),
    [
        ({"analysis": "linearisation", "at": AT, "held": True, "settle": True}, "held-and-settled"),
        (
            {"analysis": "simulation", "at": AT, "span": [0, 1], "quantity": "metric", "take": "integral"},
            "no-integrand",
        ),
        ({"analysis": "orbit"}, "unknown-column"),
        (3, "unknown-column"),
        ({"analysis": "linearisation", "take": "mass"}, "literal-error"),
    ],
)
def test_columns_that_cannot_be(column: Any, code: str) -> None:
    with pytest.raises(InvalidInput) as caught:
        Sweep(SPRUNG, {"rod": ROD}, columns={"x": column})
    assert caught.value.faults[0].pointer.startswith("/columns/x")
    assert caught.value.faults[0].code == code, caught.value.faults
