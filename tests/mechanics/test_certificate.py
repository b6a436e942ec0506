"""What a certificate says, and that no wrong formula gets one, whatever output it is of (certificate.md)."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from itertools import islice
from typing import Any

import numpy as np
import pytest
from damaged import (
    as_json,
    damages,
    errors_of,
    found_in_part,
    found_in_tree,
    has_effect,
    nudged_numbers,
    refusal,
    verified,
)
from random_trees import Kind, coordinates_of, random_definition

from substructures import Definition, Model, Part, Program, TreeSpec, catalogue, couple, derive
from substructures.certificate.compare import TOLERANCE
from substructures.documents import read_json
from substructures.errors import VerificationFailed
from substructures.expr.parse import parse
from substructures.loads import scope as loads_scope
from substructures.part.derive import recheck
from substructures.tree.certificate import certify_tree

PART: dict[str, Any] = {
    "name": "x",
    "parameters": {"l": {"value": 2, "unit": "m"}, "w": {"value": 1, "unit": "m"}, "m": {"value": 1, "unit": "kg"}},
    "bodies": [
        {
            "name": "a",
            "parent": "base",
            "joint": {"type": "revolute", "d": "sqrt(l^2-3*w^2)"},
            "mass": "m",
            "com": ["l", 0, 0],
        },
        {
            "name": "b",
            "parent": "a",
            "joint": {"type": "revolute", "d": "sqrt(l^2-3*w^2)"},
            "mass": "m",
            "com": [1, 0, 0],
        },
    ],
}


def with_parameter(name: str, value: Any) -> dict[str, Any]:
    return {**PART, "parameters": {**PART["parameters"], name: {"value": value}}}


#: a part in which every output has elements: a mast and a turret, a wrist, ports, every type of load, a fixed base
EVERYTHING: dict[str, Any] = {
    "name": "everything",
    "parameters": {"l": {"value": 0.7}, "m": {"value": 2}, "k": {"value": 30}},
    "inputs": {"u": {}},
    "bodies": [
        {"name": "ground", "parent": "base", "joint": {"type": "fixed", "sigma": 0.2, "phi": 0.3}, "mass": 4,
         "com": [0.1, 0.2, 0.3], "inertia": {"xx": 1, "yy": 2, "zz": 1.5, "xy": 0.1, "yz": 0.2}},
        {"name": "stub", "parent": "base", "mass": 1, "com": [0.1, 0, 0.2], "inertia": {"xx": 1, "yy": 1, "zz": 1},
         "joint": {"type": "revolute", "coordinate": "q0", "theta": 0.4, "d": 0.3}},
        {"name": "mast", "parent": "ground", "mass": "m", "com": ["l/2", 0.1, 0.2],
         "inertia": {"xx": 1, "yy": 1, "zz": 1},
         "joint": {"type": "revolute", "coordinate": "q1", "theta": 0.4, "d": "l", "tau": 0.3, "psi": 0.2, "sigma": 0.1,
                   "stiffness": 3, "rest": 0.2, "damping": 0.5, "armature": 0.1}},
        {"name": "jib", "parent": "mast", "mass": 1.5, "com": [0.3, 0.2, "l/3"],
         "inertia": {"xx": 0.4, "yy": 0.5, "zz": 0.6, "xz": 0.05, "about": "origin"},
         "joint": {"type": "prismatic", "coordinate": "x", "tau": 0.2,
                   "placement": {"position": ["l", 0.1, 0], "rpy": [0.3, 0.2, 0.1]}, "axis": [1, 2, -0.5]}},
        {"name": "hook", "parent": "jib", "mass": 0.5, "com": [0, 0.1, 0.2],
         "inertia": {"xx": 0.1, "yy": 0.1, "zz": 0.1},
         "joint": {"type": "universal", "coordinate": ["a", "b"], "theta": 1.2, "d": 0.4, "damping": [0.1, 0.2]}},
    ],
    "ports": [{"name": "tip", "body": "hook", "position": [0.1, "l", 0.2], "rotation": {"rpy": [0.1, 0.5, 0.2]}},
              {"name": "foot", "body": "base", "position": [1, 2, 3]}],
    "loads": [
        {"type": "force", "body": "hook", "at": [0.1, 0.2, 0.3], "vector": ["u", "-2*x'", "sin(t)"]},
        {"type": "torque", "body": "jib", "vector": [1, "q1", "u^2"], "frame": "world"},
        {"type": "joint", "coordinate": "x", "force": "-3*x - x^3"},
        {"type": "spring", "from": {"body": "ground", "at": [0, 0, 1]}, "to": {"body": "hook", "at": [0.2, 0, 0]},
         "stiffness": "k", "damping": 2, "length": 0.5},
    ],
}  # fmt: skip


def tree_of_everything() -> tuple[TreeSpec, dict[str, Part], Model]:
    """Two of them on each other, one with other parameters, tied by three closures."""
    closures = [
        {"name": "c1", "type": "universal", "from": "y.tip", "to": "x.jib", "axis": [1, 1, 2],
         "placement": {"position": [0.2, 0.1, 0], "rpy": [0.1, 0, 0.4]}},
        {"name": "c2", "type": "rod", "from": "x.mast", "to": "world", "length": "s"},
        {"name": "c3", "type": "weld", "from": "y.hook", "to": "x.foot"},
    ]  # fmt: skip
    place = {"position": ["s", 0.2, 0.1], "rpy": [0.2, 0.3, "s"]}
    bound = {"l": "2*s", "m": 3}
    mounts = [
        {"name": "y", "substructure": "everything", "at": "x.tip", "placement": place, "parameters": bound},
        {"name": "x", "substructure": "everything", "placement": {"rpy": [0, 0.3, 0]}, "parameters": {"k": "y.l + s"}},
    ]
    gravity = [1, "-2*s", -9]
    spec = TreeSpec.read(
        {"name": "t", "gravity": gravity, "parameters": {"s": {}}, "instances": mounts, "closures": closures}
    )
    part = derive(Definition.read(EVERYTHING))
    parts = {"x": part, "y": part}
    return spec, parts, couple(spec, parts)


def test_every_output_is_compared() -> None:
    part = derive(Definition.read(EVERYTHING))
    assert all(output.entries for output in part.program.outputs.values())
    _, _, model = tree_of_everything()
    assert all(output.entries for output in model.program.outputs.values())
    for certificate, program in ((part.certificate, part.program), (model.certificate, model.program)):
        errors = errors_of(certificate)
        assert errors.keys() == program.outputs.keys()
        assert all(error is not None and error <= TOLERANCE for error in errors.values())


def test_formulas_that_do_not_exist_everywhere_are_checked_at_the_defaults() -> None:
    part = derive(Definition.read(PART))
    tree = TreeSpec.read({"name": "t", "instances": [{"name": "x", "substructure": "x"}]})
    for certificate in (part.certificate, couple(tree, {"x": part}).certificate):
        assert all(error is not None and error <= TOLERANCE for error in errors_of(certificate).values())
    # without a default there is no state at which the root exists
    nowhere = {**PART, "parameters": {**PART["parameters"], "l": {"value": 0}}}
    nowhere["bodies"] = [{**body, "joint": {"type": "revolute", "d": "sqrt(l^2-3*w^2)"}} for body in PART["bodies"]]
    nowhere["bodies"][0]["joint"]["tau"] = "sqrt(-1-w^2)"
    errors = errors_of(derive(Definition.read(nowhere)).certificate)
    assert errors["tau"] is None
    assert errors["E"] is not None


def test_definiteness_is_said() -> None:
    assert derive(Definition.read(PART)).certificate["positive_definite"] is True
    assert derive(Definition.read(with_parameter("m", 0))).certificate["positive_definite"] is False
    assert derive(Definition.read(with_parameter("m", None))).certificate["positive_definite"] is None
    # a wheel of a milligram on a cart of a ton
    cart = {"name": "cart", "parent": "base", "joint": {"type": "prismatic"}, "mass": 1000}
    wheel = {
        "name": "wheel",
        "parent": "cart",
        "joint": {"type": "revolute"},
        "inertia": dict.fromkeys(("xx", "yy", "zz"), "1e-12"),
    }
    assert derive({"name": "light", "bodies": [cart, wheel]}).certificate["positive_definite"] is True


@pytest.mark.parametrize(
    "axis",
    [
        ["sqrt(5 + 2*sqrt(6)) - sqrt(2) - sqrt(3)", 1, 0],
        ["sqrt(2) + sqrt(3)", "sqrt(5 + 2*sqrt(6))", 5],
        ["sqrt(8)", "2*sqrt(2)", "1 + sqrt(8) - 1"],
        ["1e-330", 0, 0],
    ],
)
def test_an_axis_is_the_same_however_it_is_written(axis: list[Any]) -> None:
    """Components that are zero, or equal, which neither formulas nor doubles show."""
    joint = {"type": "revolute", "placement": {"rpy": [0.1, 0.2, 0.3]}, "axis": axis}
    body = {"name": "b", "parent": "base", "joint": joint, "mass": 1, "com": [0.1, 0.2, 0.3]}
    assert max(errors_of(derive({"name": "a", "bodies": [body]}).certificate).values()) <= TOLERANCE


def test_damage_of_any_output_of_a_part_is_found() -> None:
    part, rng = derive(Definition.read(EVERYTHING)), np.random.default_rng(1)
    tried = 0
    for kind, place, wrong in damages(part.program, rng, kinds=1):
        found = found_in_part(part, wrong)
        assert found is not None, (kind, place)
        assert place.partition("[")[0] in found, (kind, place, found)
        tried += 1
    assert tried > 0.9 * len(part.program.outputs)


def test_damage_of_any_output_of_a_tree_is_found() -> None:
    spec, parts, model = tree_of_everything()
    rng = np.random.default_rng(2)
    for kind, place, wrong in damages(model.program, rng, kinds=1):
        found = found_in_tree(spec, parts, model, wrong)
        assert found is not None, (kind, place)
        assert place.partition("[")[0] in found, (kind, place, found)


def test_damage_is_told_as_where_nothing_is_known() -> None:
    """In the words of certificates that compute all of it anew, of programs that a store gives back as they are."""
    part, rng = derive(Definition.read(EVERYTHING)), np.random.default_rng(1)
    found = [wrong for *_, wrong in (*damages(part.program, rng, kinds=1), *nudged_numbers(part.program))][::12]
    for wrong in found:
        assert Program.from_bytes(wrong.to_bytes()) == wrong
        assert found_in_part(part, wrong) == refusal(lambda wrong=wrong: recheck(replace(part, program=wrong)))
    spec, parts, model = tree_of_everything()
    definitions, summary = {name: x.definition for name, x in parts.items()}, model.summary()
    for *_, wrong in islice(damages(model.program, rng, kinds=1), 0, None, 6):
        anew = refusal(lambda wrong=wrong: certify_tree(spec, definitions, summary, wrong))
        assert found_in_tree(spec, parts, model, wrong) == anew is not None


# takes seconds: each damage is certified anew
def test_a_wrong_part_makes_no_wrong_model() -> None:
    """The tree is compared with the definitions of its parts: whatever coupling takes from a wrong part is found."""
    part = derive(Definition.read(EVERYTHING))
    mounts = [{"name": "x", "substructure": "a"}, {"name": "y", "substructure": "a", "at": "x.tip"}]
    spec = TreeSpec.read({"name": "t", "gravity": [1, 2, 3], "instances": mounts})
    right = couple(spec, {"x": part, "y": part}).program
    alone = TreeSpec.read({"name": "t", "gravity": [1, 2, 3], "instances": mounts[:1]})
    used = ("inertia.m", "frame.position", "Omega", "applied", "potential", "metric", "christoffel", "Z")
    refused = set()
    for kind, place, wrong in damages(part.program, np.random.default_rng(3), kinds=1):
        name = place.partition("[")[0]
        if name not in (*used, "kappa"):
            continue
        try:
            if name in ("metric", "christoffel"):
                # taken over as they are stored where nothing is mounted; elsewhere they may come from momenta
                couple(alone, {"x": replace(part, program=wrong)})
            assert couple(spec, {"x": part, "y": replace(part, program=wrong)}).program == right, (kind, place)
        except VerificationFailed:
            refused.add(name)
    assert refused == set(used)


def test_a_wrong_number_is_found_at_the_scale_of_nanometres() -> None:
    """Lengths of 1e-9 m beside one of 1 m: 1e-6 of the small ones is seen."""
    small: dict[str, Any] = {
        "name": "small",
        "bodies": [
            {"name": "a", "parent": "base", "mass": 1, "joint": {"type": "revolute", "coordinate": "q", "d": 1}},
            {"name": "b", "parent": "a", "mass": 1e-27, "com": [1e-9, 2e-9, 0],
             "joint": {"type": "revolute", "coordinate": "p", "theta": 0.3, "d": 3e-9}},
        ],
        "ports": [{"name": "tip", "body": "b", "position": [1e-9, 0, 2e-9]}],
    }  # fmt: skip
    part = derive(Definition.read(read_json(as_json(small))))
    places = []
    for kind, place, wrong in [
        *damages(part.program, np.random.default_rng(4), kinds=1),
        *nudged_numbers(part.program),
    ]:
        assert found_in_part(part, wrong) is not None, (kind, place)
        places.append(place)
    assert len(places) > 40


def test_formulas_that_exist_on_one_side_only() -> None:
    """A root of a coordinate is verified where it is real; one that is lost where the documents have it is found."""
    slider: dict[str, Any] = {
        "name": "s",
        "bodies": [{"name": "b", "parent": "base", "mass": 1, "joint": {"type": "prismatic", "coordinate": "x"}}],
        "loads": [{"type": "joint", "coordinate": "x", "force": "sqrt(x) - 1/(x - 7)"}],
    }
    errors = errors_of(derive(Definition.read(slider)).certificate)
    assert all(error is not None for error in errors.values())
    slider["loads"][0]["force"] = "x"
    part = derive(Definition.read(slider))
    entry = part.program.outputs["applied"].entries[0]
    n = len(part.program.operations)
    x = next(k for k, s in enumerate(part.program.symbols) if s.name == "x")
    # Q + sqrt(x) - sqrt(x): the same function for x > 0, and none for x < 0
    more = (("sym", x), ("sqrt", n), ("sub", n + 1, n + 1), ("add", entry, n + 2))
    output = replace(part.program.outputs["applied"], entries=(n + 3,))
    outputs = {**part.program.outputs, "applied": output}
    wrong = replace(part.program, operations=(*part.program.operations, *more), outputs=outputs)
    assert "no finite value" in str(found_in_part(part, wrong))


def slider(**more: Any) -> dict[str, Any]:
    """A body on a rail; what else is given of its joint, and of the definition."""
    joint = {"type": "prismatic", "coordinate": "x"} | more.pop("joint", {})
    body = {"name": "b", "parent": "base", "mass": 1, "joint": joint}
    return {"name": "s", "parameters": {"k": {"value": 2}}, "bodies": [body], **more}


def pushed(force: str) -> dict[str, Any]:
    return slider(loads=[{"type": "joint", "coordinate": "x", "force": force}])


SPRING = {"type": "spring", "from": {"body": "base", "at": [1, 0, 0]}, "to": {"body": "b"}, "stiffness": 1}


@pytest.mark.parametrize(
    ("definition", "states"),
    [
        (pushed("-k*x' + sin(x)/(1 + tan(x)) + (x-1)^3*pi"), 1),
        (slider(joint={"axis": [1, 2, 0.5], "placement": {"rpy": [0.1, "k", "pi/4"]}, "limits": [0, 1]}), 1),
        (slider(joint={"theta": "pi/3", "damping": "k", "stiffness": 1, "rest": "k*x", "armature": 1}), 1),
        (slider(loads=[{"type": "force", "body": "b", "vector": [0, "k", "x"], "frame": "world"}]), 1),
        (slider(loads=[{"type": "potential", "potential": "cos(x)"}]), 1),
        (pushed("sqrt(x^2 + 1)"), 2),
        (slider(joint={"limits": [0, 1], "limits_act": {"stiffness": 1}}), 2),
        (slider(loads=[SPRING]), 2),
    ],
)
def test_states_that_are_needed(definition: dict[str, Any], states: int) -> None:
    """One where everything is analytic, two where there are branches."""
    part = derive(Definition.read(definition))
    assert part.certificate["states"] == states
    one = {"name": "t", "instances": [{"name": "a", "substructure": "s"}]}
    assert couple(TreeSpec.read(one), {"a": part}).certificate["states"] == states


@pytest.mark.parametrize("sign", ["", "-"])
def test_one_side_of_a_branch_does_not_suffice(sign: str) -> None:
    """sqrt(x'^2) is x' or -x' at any one state; whichever of the two the documents have, and whatever is stored."""
    plain, root = (derive(Definition.read(pushed(force))) for force in (f"{sign}x'", "sqrt(x'^2)"))
    assert found_in_part(plain, root.program) is not None
    assert found_in_part(root, plain.program) is not None
    assert found_in_part(plain, plain.program) is found_in_part(root, root.program) is None


def test_roots_of_squares_of_parameters() -> None:
    """sqrt(l^2) is not l where a length is negative."""
    joints = [{"type": "revolute", "d": f"sqrt({x}^2)"} for x in "abcdef"]
    bodies = [{"name": f"b{i}", "parent": "base", "joint": joint} for i, joint in enumerate(joints)]
    document = {"name": "s", "parameters": {x: {} for x in "abcdef"}, "bodies": bodies}
    program = derive(Definition.read(document)).program
    part = derive(Definition.read(document))
    squares = {i: operation[1] for i, operation in enumerate(program.operations) if operation[0] == "sqrt"}
    names = {i: program.operations[program.operations[k][1]] for i, k in squares.items()}
    assert len(names) == 6
    operations = tuple(names.get(i, operation) for i, operation in enumerate(program.operations))
    assert found_in_part(part, replace(program, operations=operations)) is not None


@pytest.mark.parametrize("factor", ["1e-330", "1e250", "1e-150"])
def test_values_beyond_doubles_are_compared(factor: str) -> None:
    """Where doubles underflow or overflow."""
    joint = {"type": "revolute", "coordinate": "x", "d": f"3*{factor}", "theta": 0.3}
    body = {"name": "b", "parent": "base", "mass": f"7*{factor}", "com": [0, 0, 0.5], "joint": joint}
    part = derive(Definition.read({"name": "s", "bodies": [body]}))
    assert len([*nudged_numbers(part.program)]) > 4
    for kind, place, wrong in nudged_numbers(part.program):
        assert found_in_part(part, wrong) is not None, (kind, place)


def test_structure_is_compared_too() -> None:
    part = derive(Definition.read(EVERYTHING))
    program = part.program
    outputs = dict(program.outputs)
    del outputs["kappa"]
    more = {**program.outputs, "kappas": program.outputs["kappa"]}
    assert "kappas is no output" in str(found_in_part(part, replace(program, outputs=more)))
    assert "kappa is missing" in str(found_in_part(part, replace(program, outputs=outputs)))
    flat = replace(program.outputs["metric"], symmetry="none")
    assert "metric" in str(found_in_part(part, replace(program, outputs={**program.outputs, "metric": flat})))
    renamed = tuple(replace(s, name="other") if s.name == "q1" else s for s in program.symbols)
    assert "'other'" in str(found_in_part(part, replace(program, symbols=renamed)))


def test_names_of_axes_are_compared_too() -> None:
    spec, parts, model = tree_of_everything()
    definitions = {name: part.definition for name, part in parts.items()}
    for name in ("coordinates", "joints", "frames", "closures"):
        right = model.summary()
        with pytest.raises(VerificationFailed, match=name):
            certify_tree(spec, definitions, {**right, name: right[name][1:]}, model.program)


def test_what_a_wrong_derivation_hands_on_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """A graph that takes two different expressions for one: both sides used to be built in it."""
    wrong = lambda graph, text, lookup: parse(graph, text.replace("l/2", "l/3"), lookup)  # noqa: E731
    monkeypatch.setattr(loads_scope, "parse", wrong)
    with pytest.raises(VerificationFailed, match="by the documents"):
        derive(Definition.read(EVERYTHING))


def dof_of(plain: dict[str, Any]) -> int:
    return sum(len(coordinates_of(body)) for body in plain["bodies"])


def joint_load(rng: np.random.Generator, plain: dict[str, Any]) -> dict[str, Any]:
    """A force on one coordinate that depends on it and on another one."""
    names = [name for body in plain["bodies"] for name in coordinates_of(body)]
    a, b = (str(rng.choice(names)) for _ in range(2))
    force = f"-1.3*{a}^3 + 0.7*sin(2*{a} + 1) - 0.2*{a}*{b}^2 + u1*{b} - 0.4*{a}' + 2.5 + 0.3*sin(t)"
    return {"type": "joint", "coordinate": a, "force": force}


DAMAGED = (
    *("acrobot", "puma560", "scara", "kuka-iiwa-14", "excavator-arm", "flyball-governor", "satellite", "quadrotor"),
    *("slider-crank", "gimbal-gyroscope", "humanoid-leg", "stewart-leg", "trolley-crane", "drive-train"),
)


def damaged(number: int) -> Definition:
    """A part of the catalogue, or a random one with joint loads, whose potential is found by integration."""
    if number < len(DAMAGED):
        return Definition.read(catalogue.load(DAMAGED[number]))
    rng = np.random.default_rng(number - len(DAMAGED))
    plain = random_definition(rng, Kind(bodies=4, loads=3, springs=1))
    plain["loads"] += [joint_load(rng, plain) for _ in range(2)] if dof_of(plain) else []
    return Definition.read(read_json(as_json(plain)))


@pytest.mark.deep
@pytest.mark.parametrize("number", range(20))
def test_damage_of_twenty_mechanisms_is_found(number: int) -> None:
    """Every output of parts of the catalogue and of random ones, and every number in their programs."""
    definition = damaged(number)
    counts: Counter[str] = Counter()
    missed = []
    part, rng = derive(definition), np.random.default_rng(number)
    for kind_, place, wrong in [*damages(part.program, rng), *nudged_numbers(part.program)]:
        counts[str(kind_)] += 1
        if found_in_part(part, wrong) is None and has_effect(part.program, wrong, verified(part)):
            missed.append((kind_, place))
    instances = [
        {"name": "x", "substructure": "a"},
        {"name": "y", "substructure": "a", "at": "x.base", "placement": {"position": [0.3, 0.1, 0.2]}},
    ]
    spec = TreeSpec.read({"name": "t", "gravity": [1, 2, -9], "instances": instances})
    parts = {"x": part, "y": part}
    model = couple(spec, parts)
    for kind_, place, wrong in damages(model.program, rng):
        counts[f"tree: {kind_}"] += 1
        if found_in_tree(spec, parts, model, wrong) is None:
            missed.append((kind_, place))
    assert not missed
    assert counts


def test_older_certificates_are_read() -> None:
    """Certificates that know of two outputs only, of none, and of one without a value."""
    part = derive(Definition.read(PART))
    for errors, told in (
        ({"metric": 1e-16, "christoffel": 2e-16}, "2e-16"),
        ({}, "not verified"),
        ({"metric": None}, "not"),
    ):
        older = Part.load(part.definition, part.program.to_bytes(), {"direct_form": {"max_relative_error": errors}})
        assert told in repr(older)
    assert "not verified" in repr(Part.load(part.definition, part.program.to_bytes(), {}))
