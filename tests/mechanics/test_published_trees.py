"""A tree as a part: mounted anywhere it does what the tree does, under names of its own, over several levels."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from catalogue_entries import shipped_part

from substructures import Definition, InvalidDocument, Model, Part, TreeSpec, catalogue, couple, derive, evaluate
from substructures.errors import VerificationFailed
from substructures.part.derive import recheck
from substructures.tree.publishing.published import Publication, published
from substructures.tree.publishing.published_formulas import published_part

QUANTITIES = ("metric", "christoffel", "gravity", "forces", "bias", "potential_energy")
Instances = list[dict[str, Any]]
ROD: dict[str, Any] = {
    "name": "rod",
    "parameters": {"l": {"value": 0.7, "unit": "m"}, "m": {"value": 900, "unit": "g"}, "exp": {"value": 0.2}},
    "inputs": {"wind": {}},
    "bodies": [
        {"name": "foot", "parent": "base", "joint": {"type": "fixed"}, "mass": 0.5, "com": [0, 0.1, 0]},
        {
            "name": "stick",
            "parent": "foot",
            "joint": {
                "type": "universal",
                "coordinate": ["q", "p"],
                "damping": [0.1, 0],
                "limits": [[-2, 2], ["-exp", 3]],
            },
            "mass": "m",
            "com": ["l/2", 0, "exp*exp(-exp)"],
            "inertia": {"xx": "0.03*m", "yy": "0.03*m", "zz": "0.04*m", "xy": 0.001},
        },
    ],
    "ports": [{"name": "tip", "body": "stick", "position": ["l", 0, 0], "rotation": {"rpy": [0.2, "pi/3", -0.4]}}],
    "loads": [
        {"type": "spring", "from": {"body": "base"}, "to": {"body": "stick", "at": ["l", 0, 0]}, "stiffness": 3},
        {"type": "joint", "coordinate": "q", "force": "wind - 0.2*q'"},
        {"type": "force", "body": "stick", "at": ["l", 0, 0], "vector": [0, "0.3*exp", "wind"], "frame": "world"},
        {"type": "potential", "potential": "0.1*q*p^2"},
    ],
}


def rod() -> Part:
    return derive(Definition.read(ROD))


def spec_of(instances: Instances, **more: Any) -> TreeSpec:
    given = {
        "name": "cell",
        "gravity": [0.3, "-g", 1],
        "parameters": {"g": {"value": 9.81}, "h": {"value": 0.2, "unit": "m"}},
    }
    return TreeSpec.read({**given, "instances": instances, **more})


def module_of(spec: TreeSpec, parts: dict[str, Part], **wanted: Any) -> tuple[Part, dict[str, str]]:
    found = published(spec, parts, Publication({"name": "module"}, **wanted))
    part, single = published_part(found, parts), derive(found.definition)
    assert part.coordinates == single.coordinates
    assert part.program.outputs.keys() == single.program.outputs.keys()
    return part, dict(found.names)


def mounted(part: Part) -> Model:
    return couple(spec_of([{"name": "x", "substructure": "module"}]), {"x": part})


def require_same(tree: Model, part: Part, names: dict[str, str]) -> None:
    """All quantities at random states, inputs and parameters; in the order of the coordinates of the tree."""
    alone, rng = mounted(part), np.random.default_rng(3)
    assert [f"x.{names[name]}" for name in tree.coordinates] == list(alone.coordinates)
    given = {name: rng.uniform(0.5, 1.5) for name in tree.parameters if "." in name}
    inputs = {name: rng.uniform(-1, 1) for name in tree.input_names}
    states = {"q": rng.uniform(-1, 1, (4, tree.dof)), "qd": rng.uniform(-1, 1, (4, tree.dof))}

    def there(name: str) -> str:
        """What a parameter or input is called where the part is mounted."""
        return f"tau.x.{names[name[4:]]}" if name.startswith("tau.") else f"x.{names[name]}"

    ours = evaluate(tree, QUANTITIES, parameters=given, inputs=inputs, **states)
    moved = {there(name): x for name, x in given.items()}, {there(name): x for name, x in inputs.items()}
    theirs = evaluate(alone, QUANTITIES, parameters=moved[0], inputs=moved[1], **states)
    for name in QUANTITIES:
        scale = np.abs(ours[name]).max()
        np.testing.assert_allclose(theirs[name], ours[name], rtol=0, atol=1e-12 * max(scale, 1), err_msg=name)


def test_a_module_does_what_the_tree_does() -> None:
    """Mounted at ports that turn, with placements, bindings to numbers, units and expressions, and loads of both."""
    place = {"position": [0, 0.1, "h"], "rpy": [0.3, 0, "a.exp/2"]}
    spec = spec_of(
        [
            {
                "name": "c",
                "substructure": "rod",
                "at": "b.tip",
                "parameters": {"l": "a.l/2", "m": {"value": 350, "unit": "g"}},
            },
            {"name": "a", "substructure": "rod", "placement": {"rpy": [0, 0.4, 0]}},
            {"name": "b", "substructure": "rod", "at": "a.tip", "placement": place, "parameters": {"m": "a.m + c.m"}},
            {"name": "d", "substructure": "rod", "at": "a.foot", "parameters": {"exp": 0.1}},
        ],
        inputs={"pull": {}},
        loads=[
            {
                "name": "s",
                "type": "spring",
                "from": "b.tip",
                "to": "world",
                "from_at": [0.1, 0, 0],
                "stiffness": 4,
                "length": 0.1,
            },
            {"name": "f", "type": "force", "to": "c.tip", "at": [0, 0.1, 0], "vector": ["pull", 1, 0]},
            {"name": "w", "type": "force", "to": "c.stick", "vector": [0, "2*pull", 0], "axes": "world"},
            {
                "name": "t",
                "type": "torque",
                "from": "a.stick",
                "to": "c.tip",
                "vector": [0.1, "pull", 0],
                "axes": "world",
            },
            {"name": "j", "type": "joint", "coordinate": "a.q", "force": "-0.1*a.q'*b.p"},
            {"name": "v", "type": "potential", "potential": "0.2*sin(a.q - c.p)*h"},
        ],
    )
    parts = dict.fromkeys("abcd", rod())
    part, names = module_of(spec, parts)
    assert {"a_l", "h", "b_exp"} <= set(part.parameters)
    assert {"g", "b_m", "c_l", "c_m", "d_exp"}.isdisjoint(part.parameters)
    require_same(couple(spec, parts), part, names)


def test_modules_of_modules() -> None:
    arm = shipped_part("acrobot")
    parts = {"one": arm, "two": rod()}
    spec = spec_of(
        [{"name": "one", "substructure": "acrobot"}, {"name": "two", "substructure": "rod", "at": "one.tip"}]
    )
    inner, _ = module_of(
        spec, parts, free=tuple(n for n, p in couple(spec, parts).parameters.items() if p["value"] is None)
    )
    two = {"left": inner, "right": inner}
    seat = {"position": ["h", 0, 0], "rpy": [0.1, 0.2, 0.3]}
    outer = spec_of(
        [
            {"name": "left", "substructure": "module"},
            {"name": "right", "substructure": "module", "at": "left.two_tip", "placement": seat},
        ]
    )
    part, names = module_of(outer, two)
    assert (part.dof, names["right.two_q"]) == (8, "right_two_q")
    require_same(couple(outer, two), part, names)


@pytest.mark.parametrize(
    ("first", "second"), [("puma560", "puma560"), ("puma560", "parallel-gripper"), ("ur5", "parallel-gripper")]
)
def test_a_module_takes_no_more_operations(first: str, second: str) -> None:
    """For each state than the tree that it was; what depends on parameters alone is done once."""
    parts = {name: shipped_part(part) for name, part in (("a", first), ("b", second))}
    spec = spec_of([{"name": "a", "substructure": first}, {"name": "b", "substructure": second, "at": "a.flange"}])
    part, _ = module_of(spec, parts)
    tree, module = couple(spec, parts), mounted(part)
    per_state = [m.program.count(["metric", "christoffel", "forces"], per_state=True)["total"] for m in (module, tree)]
    assert per_state[0] <= per_state[1]
    assert module.operations["total"] <= 1.01 * tree.operations["total"]


@pytest.mark.parametrize("rpy", [[0, "pi/2", 0], ["pi/2", 0, "pi/2"], [0, "-pi/2", "pi"]], ids=str)
def test_seats_that_change_places_of_axes(rpy: list[Any]) -> None:
    """What such a seat makes of a joint has one matrix, whatever factors it has been formed by."""
    pendulum = shipped_part("simple-pendulum")
    port = pendulum.frames[-1]
    spec = spec_of(
        [
            {"name": "a", "substructure": "simple-pendulum", "placement": {"rpy": rpy}},
            {"name": "b", "substructure": "simple-pendulum", "at": f"a.{port}", "placement": {"rpy": rpy}},
        ]
    )
    parts = {"a": pendulum, "b": pendulum}
    require_same(couple(spec, parts), *module_of(spec, parts))


def test_the_humanoid_becomes_a_part() -> None:
    spec = TreeSpec.read(catalogue.load_tree("humanoid"))
    known = {str(i.substructure): shipped_part(str(i.substructure)) for i in spec.instances}
    parts = {i.name: known[str(i.substructure)] for i in spec.instances}
    found = published(spec, parts, Publication({"name": "module"}))
    assert len(published_part(found, parts).coordinates) == 34


def test_ports_and_parameters_are_chosen() -> None:
    spec = spec_of([{"name": "a", "substructure": "rod", "parameters": {"l": {"value": 50, "unit": "cm"}}}])
    part, _ = module_of(
        spec, {"a": rod()}, ports={"end": "a.tip", "middle": "a.stick"}, free=("a.l",), defaults={"a.m": 2}
    )
    assert part.ports == ("end", "middle")
    defaults = {name: float(x["value"]) for name, x in part.parameters.items()}
    assert defaults == {"a_l": 0.5, "a_m": 2.0, "a_exp": 0.2}


def test_names_that_are_taken_or_too_long() -> None:
    long = "a" * 40
    renamed = {
        **ROD,
        "bodies": [{**body, "name": f"{body['name']}{long}"} for body in ROD["bodies"]],
        "loads": [],
        "ports": [],
    }
    renamed["bodies"][1]["parent"] = renamed["bodies"][0]["name"]
    odd = {**renamed, "parameters": {**ROD["parameters"], "b_l": {"value": 2}}}
    parts = {
        "a": derive(Definition.read(odd)),
        "a_b": derive(Definition.read(renamed)),
        "c" * 40: derive(Definition.read(renamed)),
    }
    part, names = module_of(spec_of([{"name": name, "substructure": "rod"} for name in parts]), parts)
    assert (names["a.b_l"], names["a_b.l"]) == ("a_b_l", "a_b_l_2")
    assert all(len(name) <= 64 for name in names.values())
    require_same(couple(spec_of([{"name": n, "substructure": "rod"} for n in parts]), parts), part, names)


@pytest.mark.parametrize(
    ("more", "wanted", "code", "said"),
    [
        ({}, {"ports": {"end": "a.tipp"}}, "unknown-port", "did you mean 'a.tip'"),
        ({}, {"free": ("a.ll",)}, "unknown-parameter", "no parameter 'a.ll'"),
        ({}, {"free": ("b.l",)}, "bound", "'b.l' is bound to 'a.l'"),
        ({}, {"defaults": {"b.l": 3}}, "bound", "name it in 'free'"),
        ({"parameters": {"k": {"unit": "m"}, "g": {"value": 9}}, "bind": "k"}, {}, "unbound-name", "'k' has no value"),
    ],
)
def test_what_is_no_part(more: dict[str, Any], wanted: dict[str, Any], code: str, said: str) -> None:
    bound = more.pop("bind", "a.l")
    two: Instances = [{"name": "b", "substructure": "rod", "at": "a.tip", "parameters": {"l": bound}}]
    spec = spec_of([{"name": "a", "substructure": "rod"}, *two], **more)
    with pytest.raises(InvalidDocument) as raised:
        module_of(spec, {"a": rod(), "b": rod()}, **wanted)
    fault = raised.value.faults[0]
    assert (fault.code, said in fault.message) == (code, True), fault


def test_nothing_inside_of_a_part_is_derived_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """The formulas are coupled out of the stored ones, and are verified like those of any part."""
    parts = {"a": rod(), "b": rod()}
    spec = spec_of([{"name": "a", "substructure": "rod"}, {"name": "b", "substructure": "rod", "at": "a.tip"}])
    found = published(spec, parts, Publication({"name": "module"}))

    def refused(*_: Any) -> None:
        """What derives."""
        raise AssertionError("derived again")

    for name in ("base_functions", "composites", "own_dynamics"):
        monkeypatch.setattr(f"substructures.part.formulas.{name}", refused)
    part = published_part(found, parts)
    assert recheck(part)["direct_form"]["max_relative_error"].keys() == part.program.outputs.keys()
    with pytest.raises(AssertionError, match="derived again"):
        derive(found.definition)


def test_a_wrong_stored_formula_is_found() -> None:
    """A part whose program is not what its definition says makes no module."""
    right, stick = rod(), ROD["bodies"][1]
    moved = {**stick, "joint": {**stick["joint"], "d": 0.1}}
    other = derive(Definition.read({**ROD, "bodies": [ROD["bodies"][0], moved]}))
    parts = {"a": Part(right.definition, other.program, right.certificate)}
    found = published(spec_of([{"name": "a", "substructure": "rod"}]), parts, Publication({"name": "module"}))
    with pytest.raises(VerificationFailed):
        published_part(found, parts)
