"""Closures of definitions: a tree has those of its parts, as if they were its own, and hosts have nothing to do with
them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from made_once import derived_once

from substructures import (
    Definition,
    InvalidDocument,
    Model,
    Part,
    TreeSpec,
    catalogue,
    couple,
    derive,
    evaluate,
    simulate,
)
from substructures.analysis.closed.loops import loop_state
from substructures.documents import read_json
from substructures.errors import VerificationFailed
from substructures.export.robots import file_of_part
from substructures.expr.bind import bind
from substructures.expr.program import Program
from substructures.pictures.scene import scene
from substructures.quantities.reactions import reactions
from substructures.tree import reading
from substructures.tree.publishing.published import Publication, published
from substructures.tree.publishing.published_formulas import published_part

Plain = dict[str, Any]
OPEN: Plain = dict(catalogue.load("four-bar"))
PLACE: Plain = {"position": ["l3", 0, 0], "rpy": [0, 0, 0.1]}
#: the pin at the end of the rocker as a placement in its body, a redundant one, and a rod to the base
CLOSURES: list[Plain] = [
    {"name": "pin", "type": "pin", "from": "coupler_end", "to": "rocker", "placement": PLACE},
    {"name": "stay", "type": "rod", "from": "rocker", "length": {"value": 400, "unit": "mm"}},
]
CLOSED: Plain = {**OPEN, "name": "linkage", "closures": CLOSURES}
ARM: Plain = dict(catalogue.load("planar-2r"))
#: hosts after what they carry, so that the order of closures is that of the model
INSTANCES: list[Plain] = [
    {"name": "hand", "substructure": "linkage", "at": "arm.flange", "parameters": {"l1": 0.12, "l3": "arm.l1/2"}},
    {"name": "arm", "substructure": "planar-2r"},
    {"name": "foot", "substructure": "linkage", "placement": {"rpy": [0.3, 0, 0]}},
]
GRAVITY = [0, -9.81, 1]
OWN: Plain = {"name": "rope", "type": "rod", "from": "arm.flange", "to": "foot.rocker_end", "length": 2}


def prefixed(closure: Plain, instance: str) -> Plain:
    """A closure of a definition as one of a tree."""
    to = f"{instance}.{closure.get('to', 'base')}"
    place = {**PLACE, "position": [f"{instance}.l3", 0, 0]} if "placement" in closure else {}
    more = {"placement": place} if place else {}
    return {
        **closure,
        "name": f"{instance}_{closure['name']}",
        "from": f"{instance}.{closure['from']}",
        "to": to,
        **more,
    }


def parts(hand: Plain) -> dict[str, Part]:
    return {"hand": derived_once(hand), "arm": derived_once(ARM), "foot": derived_once(hand)}


def tree(*closures: Plain) -> Plain:
    return {"name": "cell", "gravity": GRAVITY, "instances": INSTANCES, "closures": [OWN, *closures]}


def closed() -> Model:
    return couple(tree(), parts(CLOSED))


def test_a_tree_has_the_closures_of_its_parts_like_its_own() -> None:
    """The same program bit by bit; rows in the order of the model: foot stands before hand only in the document."""
    told = [prefixed(closure, name) for name in ("hand", "foot") for closure in CLOSURES]
    order = ["foot", "hand"] if list(closed().coordinates)[2].startswith("foot") else ["hand", "foot"]
    own = couple(tree(*sorted(told, key=lambda c: order.index(c["name"].split("_")[0]))), parts(OPEN))
    assert closed().program.digest == own.program.digest
    assert closed().coordinates == own.coordinates
    assert [rows.name for rows in closed().closures] == ["rope", *(f"{n}.{c}" for n in order for c in ("pin", "stay"))]
    ends = {rows.name: (rows.start, rows.end) for rows in closed().closures}
    assert ends["hand.stay"] == ("hand.rocker", "hand.base")


def test_hosts_have_nothing_to_do_with_them() -> None:
    """phi and G of a part are the same numbers wherever it hangs, and G_ka = 0 of host coordinates exactly."""
    alone = couple(
        {**tree(), "closures": [], "instances": [{"name": "hand", "substructure": "linkage"}]}, parts(CLOSED)
    )
    rng, model = np.random.default_rng(4), closed()
    own = [model.coordinates.index(name) for name in alone.coordinates]
    q, qd = rng.uniform(-1, 1, (2, 5, model.dof))
    given = {"arm.l1": 0.9}
    names = ["closure.residual", "closure.jacobian", "closure.acceleration"]
    found = evaluate(model, names, q=q, qd=qd, parameters=given)
    wanted = evaluate(alone, names, q=q[:, own], qd=qd[:, own], parameters={"hand.l1": 0.12, "hand.l3": 0.45})
    k = [r.name for r in model.closures for _ in r.rows].index("hand.pin")
    rows = slice(k, k + 6)
    for name in names:
        mine = found[name][:, rows] if name != "closure.jacobian" else found[name][:, rows][:, :, own]
        np.testing.assert_allclose(mine, wanted[name], rtol=0, atol=1e-14)
    others = [a for a in range(model.dof) if a not in own]
    assert not found["closure.jacobian"][:, rows][:, :, others].any()


def test_motions_of_the_closed_part_are_judged_right() -> None:
    spec = {"name": "m", "gravity": GRAVITY, "instances": [{"name": "x", "substructure": "linkage"}]}
    linkage = {**CLOSED, "closures": [{**CLOSURES[0], "placement": {"position": ["l3", 0, 0]}}]}
    motion = simulate(couple(spec, {"x": derived_once(linkage)}), [1.0, -0.3, 1.9], (0, 0.5))
    assert motion.is_right, motion


def test_reactions_that_are_not_unique_are_told_by_closure() -> None:
    """Of a pin in a plane mechanism those across the plane, under the name that it has in the tree."""
    spec = {"name": "m", "gravity": GRAVITY, "instances": [{"name": "x", "substructure": "linkage"}]}
    linkage = {**CLOSED, "closures": [{**CLOSURES[0], "placement": {"position": ["l3", 0, 0]}}]}
    found = loop_state(couple(spec, {"x": derived_once(linkage)}), [1.0, -0.3, 1.9])
    assert found.mobility.dependent == ("x.pin.z", "x.pin.rx", "x.pin.ry")
    assert [(each.closure, each.not_unique) for each in found.reactions] == [("x.pin", ("z", "rx", "ry"))]


def test_a_closed_tree_becomes_a_part() -> None:
    """Its closures and those of its parts, under names of the part; mounted it is what the tree is."""
    own = parts(CLOSED)
    spec = TreeSpec.read(
        {**tree(), "parameters": {"h": {"value": 2, "unit": "m"}}, "closures": [{**OWN, "length": "h"}]}
    )
    found = published(spec, own, Publication({"name": "cell-part"}))
    part = published_part(found, own)
    assert "h" in part.parameters
    names = [closure.name for closure in part.definition.closures]
    assert (names[0], set(names)) == ("rope", {"rope", "hand_pin", "hand_stay", "foot_pin", "foot_stay"})
    mounted = couple({"name": "m", "gravity": GRAVITY, "instances": [{"name": "x", "substructure": "y"}]}, {"x": part})
    model, rng = couple(spec, own), np.random.default_rng(6)
    assert [f"x.{found.names[name]}" for name in model.coordinates] == list(mounted.coordinates)
    q, qd = rng.uniform(-1, 1, (2, 3, model.dof))
    for name in ("closure.residual", "closure.jacobian", "closure.acceleration", "metric", "forces"):
        ours, theirs = (evaluate(m, [name], q=q, qd=qd)[name] for m in (model, mounted))
        np.testing.assert_allclose(theirs, ours, rtol=0, atol=1e-13)


def test_reactions_and_pictures_have_them() -> None:
    own = parts(CLOSED)
    program = reactions(TreeSpec.read(tree()), own).program
    assert {"lambda.hand.pin.x", "lambda.rope.length"} <= {symbol.name for symbol in program.symbols}
    drawn = {each["name"]: each for each in scene(TreeSpec.read(tree()), own, closed())["closures"]}
    assert set(drawn) == {"rope", "hand.pin", "hand.stay", "foot.pin", "foot.stay"}
    assert drawn["hand.pin"]["ends"][1]["at"] == pytest.approx(
        [0.5 * float(own["arm"].parameters["l1"]["value"]), 0, 0]
    )
    values = {name: p["value"] for name, p in own["hand"].parameters.items()}

    def numbers(formulas: Program) -> Program:
        """With all defaults."""
        return bind(formulas, {s.name: values[s.name] for s in formulas.symbols if s.name in values})

    text = file_of_part("urdf", own["hand"], "linkage", "linkage@1", "", numbers)
    assert b"the closure 'pin' (pin): URDF has no loops" in text


def test_a_wrong_closure_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """The certificate reads the definitions by itself."""

    def shifted(*given: Any) -> Any:
        found = right(*given)
        return found._replace(position=(found.position[0] + 1, *found.position[1:]))

    right = reading.cut_frames
    monkeypatch.setattr(reading, "cut_frames", shifted)
    with pytest.raises(VerificationFailed, match="closure"):
        closed()


def test_nothing_else_of_a_part_changes() -> None:
    """Its formulas are those without closures; its shape is another one, and what only closures name has an effect."""
    with_loops, without = derived_once(CLOSED), derived_once(OPEN)
    assert with_loops.program.digest == without.program.digest
    assert with_loops.shape != without.shape
    named = {**CLOSED, "parameters": {**OPEN["parameters"], "s": {"value": 0.4}, "u": {"value": 1}}}
    named["closures"] = [{**CLOSURES[1], "length": "s"}]
    part = derive(named)
    assert [w["pointer"] for w in part.certificate["warnings"] if w["code"] == "no-effect"] == ["/parameters/u"]
    assert Definition.read(read_json(part.definition.canonical())) == part.definition


@pytest.mark.parametrize(
    ("change", "place", "code"),
    [
        ({"from": "coupler_ends"}, "/closures/0/from", "unknown-frame"),
        ({"to": "world"}, "/closures/0/to", "unknown-frame"),
        ({"to": "hand.base"}, "/closures/0/to", "string-pattern-mismatch"),
        ({"name": "stay"}, "/closures/1/name", "duplicate-name"),
        ({"placement": {"position": ["crank", 0, 0]}}, "/closures/0/placement/position/0", "unknown-name"),
        (
            {"placement": {"position": [{"value": 1, "unit": "kg"}, 0, 0]}},
            "/closures/0/placement/position/0",
            "unit-mismatch",
        ),
        ({"axis": [0, 0, 0]}, "/closures/0/axis", "bad-axis"),
        ({"length": 1}, "/closures/0", "rod-length"),
        ({"type": "rod", "length": -1}, "/closures/0/length", "bad-length"),
    ],
)
def test_faults_have_their_place(change: Plain, place: str, code: str) -> None:
    with pytest.raises(InvalidDocument) as raised:
        derive({**CLOSED, "closures": [{**CLOSURES[0], **change}, CLOSURES[1]]})
    assert [(fault.pointer, fault.code) for fault in raised.value.faults] == [(place, code)]
