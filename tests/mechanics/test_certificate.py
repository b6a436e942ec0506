"""What a certificate says, and that no wrong formula gets one, whatever output it is of (certificate.md)."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from damaged import damages, nudged_numbers
from random_trees import Kind, Plain, random_definition

from substructures import Definition, Model, Part, Program, TreeSpec, catalogue, couple, derive
from substructures.certificate.compare import TOLERANCE
from substructures.documents import read_json
from substructures.errors import VerificationFailed
from substructures.expr.interpret import interpret
from substructures.expr.parse import parse
from substructures.part import scope as part_scope
from substructures.part.part import recheck
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


def errors_of(certificate: Any) -> dict[str, float | None]:
    found: dict[str, float | None] = certificate["direct_form"]["max_relative_error"]
    return found


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


def found_in_part(part: Part, wrong: Program) -> str | None:
    """What the certificate of the part says of a program; None when it lets it pass."""
    try:
        recheck(replace(part, program=wrong))
    except VerificationFailed as error:
        return str(error)
    return None


def found_in_tree(spec: TreeSpec, parts: dict[str, Part], model: Model, wrong: Program) -> str | None:
    try:
        certify_tree(spec, {name: part.definition for name, part in parts.items()}, model.summary(), wrong)
    except VerificationFailed as error:
        return str(error)
    return None


def has_effect(program: Program, wrong: Program) -> bool:
    """Whether any output changes at all: a number may stand beside a factor that is zero."""
    rng = np.random.default_rng(9)
    values = {s.name: rng.uniform(-2, 2, 3) for s in program.symbols}
    before, after = interpret(program, values), interpret(wrong, values)
    return any(not np.array_equal(before[name], after[name], equal_nan=True) for name in before)


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


def test_a_wrong_part_makes_no_wrong_model() -> None:
    """The tree is compared with the definitions of its parts: whatever coupling takes from a wrong part is found."""
    part = derive(Definition.read(EVERYTHING))
    mounts = [{"name": "x", "substructure": "a"}, {"name": "y", "substructure": "a", "at": "x.tip"}]
    spec = TreeSpec.read({"name": "t", "gravity": [1, 2, 3], "instances": mounts})
    right = couple(spec, {"x": part, "y": part}).program
    used = ("inertia.m", "frame.position", "Omega", "applied", "potential", "metric", "christoffel", "Z")
    refused = set()
    for kind, place, wrong in damages(part.program, np.random.default_rng(3), kinds=1):
        name = place.partition("[")[0]
        if name not in (*used, "kappa"):
            continue
        try:
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
    part = derive(Definition.read(read_json(_json(small))))
    places = []
    for kind, place, wrong in [
        *damages(part.program, np.random.default_rng(4), kinds=1),
        *nudged_numbers(part.program),
    ]:
        assert found_in_part(part, wrong) is not None, (kind, place)
        places.append(place)
    assert len(places) > 40


def _json(data: Any) -> bytes:
    return json.dumps(data).encode()


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
    monkeypatch.setattr(part_scope, "parse", wrong)
    with pytest.raises(VerificationFailed, match="by the documents"):
        derive(Definition.read(EVERYTHING))


#: what they change
FORCES = frozenset(("applied", "potential", "forces", "potential_energy", "limits"))
#: laws whose potential is found by integration alone; nothing would be right, too
ALL_FOUND = ("laws that depend on the state", "force with a potential", "force beside one in the time")
#: parts with forces beside those above: end stops, laws that depend on the state, potentials given and found
LAWS: dict[str, Plain] = {
    "stops": {
        "joint": {"limits": [-0.1, "l/3"], "limits_act": {"stiffness": "k", "damping": 3}, "stiffness": 2, "rest": 0.3},
    },
    "potential": {"loads": [{"type": "potential", "potential": "k*x^2*cos(y - l)*(1 + u*t) + sqrt(1 + y^2)/(2 + x)"}]},
    "laws that depend on the state": {
        "joint": {"stiffness": "k*(1 + x^2)", "rest": "l - y/7", "damping": "2 + x'^2*sin(t)"},
    },
    "force with a potential": {
        "loads": [
            {"type": "joint", "coordinate": "x", "force": "-k*x*y^2 - 4*x^3 - x' + u*y + cos(2*x)"},
            {"type": "joint", "coordinate": "y", "force": "-k*x^2*y + sin(y)*y - 0.2*y'*x"},
        ],
    },
    "force with its own part": {
        "joint": {"stiffness": 3},
        "loads": [
            {"type": "joint", "coordinate": "x", "force": "k*y - 4*x^3 - x'^3 + x*sin(y)^2"},
            {"type": "joint", "coordinate": "y", "force": "-k*x - sin(y + l)"},
        ],
    },
    "force beside one in the time": {
        "loads": [{"type": "joint", "coordinate": "x", "force": "sin(t)*y - k*x^3"}],
    },
    "spring that depends on the state": {
        "loads": [
            {"type": "spring", "from": {"body": "base", "at": [0, 0, 1]}, "to": {"body": "a"},
             "stiffness": "k*(1 + x^2)", "damping": "1 + y^2"},
            {"type": "spring", "from": {"body": "base", "at": [1, 0, 1]}, "to": {"body": "b", "at": [0, "l", 0]},
             "stiffness": "k*(1 + t)", "damping": "1 + y^2", "length": "0.3 + u"},
        ],
    },
    "dead force": {
        "loads": [
            {"type": "force", "body": "b", "at": [0.2, "l", 0.1], "vector": ["k", -2, "3*l"], "frame": "world"},
            {"type": "force", "body": "base", "at": [0.2, 0, 0.1], "vector": [1, 0, 0], "frame": "world"},
            {"type": "force", "body": "a", "at": [0.2, 0, 0.1], "vector": [1, "y", 0], "frame": "world"},
        ],
    },
}  # fmt: skip


def part_with(more: Plain) -> Part:
    """A slide x along an inclined axis and a turning joint y, with a law."""
    mass = {"mass": 2, "com": [0.1, 0.2, 0], "inertia": {"xx": 1, "yy": 1, "zz": 1}}
    x = {"type": "prismatic", "coordinate": "x", "theta": 0.4} | more.get("joint", {})
    y = {"type": "revolute", "coordinate": "y", "theta": 1.1, "limits": [-1, "k"]}
    bodies = [{"name": "a", "parent": "base", "joint": x} | mass, {"name": "b", "parent": "a", "joint": y} | mass]
    loads = more.get("loads", ())
    parameters = {"k": {"value": 1.7}, "l": {"value": 0.6}}
    plain = {"name": "a", "parameters": parameters, "inputs": {"u": {}}, "bodies": bodies, "loads": loads}
    return derive(Definition.read(read_json(_json(plain))))


def two_of(part: Part) -> tuple[TreeSpec, dict[str, Part], Model]:
    """On each other, with gravity."""
    mounts = [{"name": "x", "substructure": "a"}, {"name": "y", "substructure": "a", "at": "x.b"}]
    mounts[1] |= {"parameters": {"k": "2*x.k"}, "placement": {"rpy": [0.3, 0.2, 0.1]}}
    spec, parts = TreeSpec.read({"name": "t", "gravity": [1, 2, -9], "instances": mounts}), {"x": part, "y": part}
    return spec, parts, couple(spec, parts)


@pytest.mark.parametrize("law", LAWS)
def test_damage_of_forces_and_potentials_is_found(law: str) -> None:
    """In all ways, in the part and in a tree; and every number of the program of the part."""
    part = part_with(LAWS[law])
    spec, parts, model = two_of(part)
    for certificate, program in ((part.certificate, part.program), (model.certificate, model.program)):
        errors = errors_of(certificate)
        assert errors.keys() == program.outputs.keys()
        assert all(error is not None and error <= TOLERANCE for error in errors.values())
    rng = np.random.default_rng(5)
    for kind, place, wrong in damages(part.program, rng, elements=2):
        name = place.partition("[")[0]
        if name in FORCES and not (kind == "left out" and name == "potential" and law in ALL_FOUND):
            assert found_in_part(part, wrong) is not None, (kind, place)
    for kind, place, wrong in damages(model.program, rng, elements=2):
        if place.partition("[")[0] in FORCES:
            assert found_in_tree(spec, parts, model, wrong) is not None, (kind, place)
    used = set(part.program.reachable(["applied", "potential"]))
    for kind, place, wrong in nudged_numbers(part.program):
        if int(place.removeprefix("operation ")) in used and has_effect(part.program, wrong):
            assert found_in_part(part, wrong) is not None, (kind, place)


def test_what_is_told_of_a_wrong_potential() -> None:
    """What was found by integration is compared by its gradient; a term in the time alone is none of it."""
    part = part_with(LAWS["force with its own part"])
    program, (entry,) = part.program, part.program.outputs["potential"].entries
    wrong = _with_potential(program, [("mul", entry, entry)])
    assert "the change of potential with x is" in str(found_in_part(part, wrong))
    time = next(i for i, s in enumerate(program.symbols) if s.name == "x'")
    n = len(program.operations)
    wrong = _with_potential(program, [("sym", time), ("add", entry, n)])
    assert "with the time, inputs and velocities is" in str(found_in_part(part, wrong))


def _with_potential(program: Program, more: list[Any]) -> Program:
    """The potential is the last of some operations that are added."""
    operations = (*program.operations, *more)
    potential = replace(program.outputs["potential"], entries=(len(operations) - 1,))
    return replace(program, operations=operations, outputs={**program.outputs, "potential": potential})


def test_no_gradient_is_taken_for_more_than_it_is() -> None:
    """Circulatory forces y, -x: a stored V = -x y has the gradient of one of them, and is none of both."""
    loads = [{"type": "joint", "coordinate": c, "force": f} for c, f in (("x", "y"), ("y", "-x"))]
    part = part_with({"loads": loads})
    index = {s.name: i for i, s in enumerate(part.program.symbols)}
    n = len(part.program.operations)
    more = [("sym", index["x"]), ("sym", index["y"]), ("mul", n, n + 1), ("neg", n + 2)]
    operations = (*part.program.operations, *more)
    potential = replace(part.program.outputs["potential"], entries=(n + 3,), index=((),))
    outputs = {**part.program.outputs, "potential": potential}
    wrong = replace(part.program, operations=operations, outputs=outputs)
    assert "the change of potential with x is" in str(found_in_part(part, wrong))


def test_limits_are_of_the_document() -> None:
    spec, parts, model = two_of(part_with(LAWS["stops"]))
    definitions = {name: part.definition for name, part in parts.items()}
    assert model.limited == ("x.x", "x.y", "y.x", "y.y")
    with pytest.raises(VerificationFailed, match="limited"):
        certify_tree(spec, definitions, {**model.summary(), "limited": ["x.y"]}, model.program)
    outputs = {name: x for name, x in model.program.outputs.items() if name != "limits"}
    without = replace(model.program, outputs=outputs)
    assert "limits is missing" in str(found_in_tree(spec, parts, model, without))
    # a model of a version that knew nothing of limits
    older = {name: x for name, x in model.summary().items() if name != "limited"}
    assert "limits" not in errors_of(certify_tree(spec, definitions, older, without))


#: joint loads as people write them, and worse: nothing in them may be refused
ODD = (
    ("0*x + k*y", "x*k"), ("x - x", "y/y"), ("2*x + 2*sin(t)", "1/y'"), ("u/x' - x", "x*t - x*t"),
    ("sqrt(1 + x^2)", "x*y/(1 + y^2)"), ("tan(x)", "cos(x*y)"), ("(x + t)^2*y", "cos(t)*y - k*y^3"),
    ("x^-2", "sin(y)/cos(y)"), ("cos(k*x)", "sin(x + 1/k)*k"), ("cos(x + k*l)^3*y", "sqrt(l)*y^9/(k + l)"),
    ("(1 + x + y)^9", "sqrt(x^2)"), ("-(x - (t - y))*3", "-(u - x)*y"),
)  # fmt: skip


@pytest.mark.parametrize("forces", ODD)
def test_no_law_is_refused_by_mistake(forces: tuple[str, str]) -> None:
    """As forces, as stiffnesses of joints and of springs; in a part and in a tree."""
    loads = [{"type": "joint", "coordinate": c, "force": f} for c, f in zip("xy", forces, strict=True)]
    ends = {"from": {"body": "base", "at": [0, 0, 1]}, "to": {"body": "b"}}
    springs = [{"type": "spring", "stiffness": f, **ends} for f in forces]
    springs[1]["length"] = "l"
    joint = {"stiffness": forces[0], "rest": "l"}
    for more in ({"loads": loads}, {"joint": joint, "loads": loads[1:]}, {"loads": springs}):
        two_of(part_with(more))


@pytest.mark.deep
def test_damage_of_twenty_mechanisms_is_found() -> None:
    """Every output of parts of the catalogue and of random ones, and every number in their programs."""
    names = (
        *("acrobot", "puma560", "scara", "kuka-iiwa-14", "excavator-arm", "flyball-governor", "satellite", "quadrotor"),
        *("slider-crank", "gimbal-gyroscope", "humanoid-leg", "stewart-leg", "trolley-crane", "drive-train"),
    )
    definitions = [Definition.read(catalogue.load(name)) for name in names]
    for seed in range(6):
        kind = Kind(bodies=4, loads=3, springs=1)
        definitions.append(Definition.read(random_definition(np.random.default_rng(seed), kind)))
    counts: Counter[str] = Counter()
    missed = []
    for number, definition in enumerate(definitions):
        part, rng = derive(definition), np.random.default_rng(number)
        for kind_, place, wrong in [*damages(part.program, rng), *nudged_numbers(part.program)]:
            counts[str(kind_)] += 1
            if found_in_part(part, wrong) is None and has_effect(part.program, wrong):
                missed.append((definition.name, kind_, place))
        spec = TreeSpec.read(
            {
                "name": "t",
                "gravity": [1, 2, -9],
                "instances": [
                    {"name": "x", "substructure": "a"},
                    {"name": "y", "substructure": "a", "at": "x.base", "placement": {"position": [0.3, 0.1, 0.2]}},
                ],
            }
        )
        parts = {"x": part, "y": part}
        model = couple(spec, parts)
        for kind_, place, wrong in damages(model.program, rng):
            counts[f"tree: {kind_}"] += 1
            if found_in_tree(spec, parts, model, wrong) is None:
                missed.append((definition.name, kind_, place))
    print(f"{sum(counts.values()):,} damages: {dict(counts)}")
    assert not missed
    assert len(definitions) == 20


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
