"""Trees that differ in numbers and words alone have one program and one certificate, which are made once."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from catalogue_entries import shipped_part
from damaged import damages

from substructures import Definition, Model, Part, catalogue, couple, derive
from substructures.documents import read_json, write_json
from substructures.errors import InvalidDocument, VerificationFailed
from substructures.tree.certificate import certify_tree
from substructures.tree.couple import couple_shape
from substructures.tree.document import TreeSpec
from substructures.tree.shape import CertifiedProgram


class Shapes(dict[str, CertifiedProgram]):
    """Known shapes, and how many were asked for and known."""

    hits = 0

    def get(self, key: str, /) -> CertifiedProgram | None:  # type: ignore[override]
        """One of them."""
        self.hits += key in self
        return super().get(key)

    def put(self, key: str, value: CertifiedProgram, /) -> None:
        """One more."""
        self[key] = value


def _document(name: str) -> dict[str, Any]:
    return deepcopy(catalogue.load(name))


def _varied(name: str, source: np.random.Generator) -> Part:
    """An entry with other numbers, and with other words."""
    document = _document(name) | {"name": f"x{source.integers(10**9)}", "description": "sqrt(x) of words"}
    for each in document["parameters"].values():
        each |= {"value": round(source.uniform(0.1, 0.9), 9), "description": "atan2(y, x)"}
    return derive(Definition.read(document))


ROD: dict[str, Any] = {
    "bodies": [
        {
            "name": "rod",
            "parent": "base",
            "joint": {"type": "revolute", "coordinate": "q"},
            "mass": "m",
            "com": ["l/2", 0, 0],
            "inertia": {"xx": "m/10", "yy": "m/10", "zz": "m/10"},
        }
    ],
    "loads": [{"type": "joint", "coordinate": "q", "force": "u"}],
    "ports": [{"name": "flange", "body": "rod", "position": ["l*sqrt(k)", 0, 0]}],
}


def test_defaults_that_stand_in_formulas_or_under_roots_are_of_the_same_shape() -> None:
    """2 and 1/2 stand in formulas of a rod; a root has no value where its length is negative."""
    known, programs = Shapes(), set()
    for l, m, u in ((1, 2, 2), (2, "1/2", 3), ("0.7", 4, "1/4")):  # noqa: E741 -- its name
        values = {"l": {"value": l, "unit": "m"}, "m": {"value": m, "unit": "kg"}, "k": {"value": l, "unit": "1"}}
        inputs = {"u": {"unit": "N m", "default": u}}
        part = derive({**ROD, "name": f"rod-{m}".replace("/", "-"), "parameters": values, "inputs": inputs})
        programs.add(part.program.digest)
        parts = {"arm": part, "hand": part}
        own = {"g": {"value": m, "unit": "m/s^2"}}
        tree = {**_tree(), "gravity": [0, "-g", 0], "parameters": own, "inputs": {"w": {"unit": "N", "default": l}}}
        assert _said(couple(tree, parts, known=known)) == _said(couple(tree, parts))
    assert (len(programs), known.hits, len(known)) == (1, 2, 1)


def _tree(**bound: Any) -> dict[str, Any]:
    hand = {"name": "hand", "substructure": "x", "at": "arm.flange", "parameters": bound}
    arm = {"name": "arm", "substructure": "x"}
    own = {"g": {"value": 9.81, "unit": "m/s^2", "description": "sqrt(x)"}, "m": {"unit": "kg"}}
    return {"name": "t", "gravity": [0, 0, "-g"], "parameters": own, "instances": [arm, hand]}


def _said(model: Model) -> dict[str, Any]:
    """All that is stored, but for the time that it took."""
    summary = model.summary()
    certificate = {name: x for name, x in summary["certificate"].items() if name != "seconds"}
    return summary | {"certificate": certificate, "program": model.program.digest, "marks": model.program.not_judged}


@pytest.mark.parametrize(("arm", "hand"), [("scara", "parallel-gripper"), ("planar-2r", "simple-pendulum")])
def test_a_tree_by_its_shape_is_the_tree_by_the_slow_way(arm: str, hand: str) -> None:
    source, known = np.random.default_rng(3), Shapes()
    name = next(iter(_document(hand)["parameters"]))
    numbers = [round(source.uniform(0.1, 0.9), 6) for _ in range(2)]
    bindings: list[dict[str, Any]] = [{}, {}, {name: numbers[0]}, {name: numbers[0]}, {name: numbers[1]}, {name: "m"}]
    for bound in bindings:
        parts = {"arm": _varied(arm, source), "hand": _varied(hand, source)}
        assert _said(couple(_tree(**bound), parts, known=known)) == _said(couple(_tree(**bound), parts))
    assert (known.hits, len(known)) == (3, 3)
    couple(_tree(), parts, known=known, group=True)
    assert len(known) == 4


@pytest.mark.parametrize(("arm", "hand"), [("scara", "parallel-gripper"), ("planar-2r", "simple-pendulum")])
def test_numbers_are_put_in_as_documents_say(arm: str, hand: str) -> None:
    """The program with numbers in it against the document with these numbers, and as lean as coupled with them."""
    source, known = np.random.default_rng(6), Shapes()
    parts = {"arm": _varied(arm, source), "hand": _varied(hand, source)}
    definitions = {name: part.definition for name, part in parts.items()}
    for _ in range(3):
        bound = {name: round(source.uniform(0.1, 0.9), 6) for name in parts["hand"].parameters}
        spec = TreeSpec.read(_tree(**bound))
        model = couple(spec, parts, known=known)
        assert not {f"hand.{name}" for name in bound} & model.effective
        certify_tree(spec, definitions, model.summary(), model.program)
        stored = couple_shape(spec, parts, known=known)
        assert stored.numbers == {f"hand.{name}": Fraction(str(x)) for name, x in bound.items()}
        read = Model.load(read_json(write_json(stored.summary())), stored.program.to_bytes())
        assert read.program.digest == model.program.digest != stored.program.digest
    assert (known.hits, len(known)) == (5, 1)


def test_a_wrong_number_put_in_is_found() -> None:
    parts = {"arm": shipped_part("planar-2r"), "hand": shipped_part("simple-pendulum")}
    spec = TreeSpec.read(_tree(m=0.7))
    stored = couple_shape(spec, parts)
    wrong = replace(stored, numbers={"hand.m": Fraction(71, 100)}).with_numbers()
    with pytest.raises(VerificationFailed):
        certify_tree(spec, {name: part.definition for name, part in parts.items()}, wrong.summary(), wrong.program)


def test_numbers_that_make_formulas_shorter_belong_to_the_shape() -> None:
    parts, known = {"arm": shipped_part("planar-2r"), "hand": shipped_part("simple-pendulum")}, Shapes()
    sizes = [couple_shape(_tree(m=m), parts, known=known).numbers for m in (0, 1, "-1", "0.25", 0.25)]
    assert sizes == [{}, {}, {}, {"hand.m": Fraction(1, 4)}, {"hand.m": Fraction(1, 4)}]
    assert (known.hits, len(known)) == (1, 4)


def _placed(z: Any, roll: Any) -> dict[str, Any]:
    tree = _tree()
    tree["instances"][1]["placement"] = {"position": [0, 0, z], "rpy": [roll, 0, 0]}
    return tree


@pytest.mark.parametrize(("arm", "hand"), [("scara", "parallel-gripper"), ("planar-2r", "simple-pendulum")])
def test_numbers_of_placements_are_put_in_as_documents_say(arm: str, hand: str) -> None:
    """Against the document with these numbers, and as lean as coupled with them as fractions, which stay."""
    parts, known = {"arm": shipped_part(arm), "hand": shipped_part(hand)}, Shapes()
    definitions = {name: part.definition for name, part in parts.items()}
    for z, roll in ((0.11, 0.3), ({"value": 270, "unit": "mm"}, "-0.7"), ({"value": -1.5, "unit": "cm"}, 2)):
        spec = TreeSpec.read(_placed(z, roll))
        stored = couple_shape(spec, parts, known=known)
        assert stored.numbers.keys() == {"hand.position.z", "hand.rpy.x"} <= stored.effective
        model = stored.with_numbers()
        assert not stored.numbers.keys() & {*model.parameters, *model.effective}
        certify_tree(spec, definitions, model.summary(), model.program)
        assert _said(model) == _said(couple(spec, parts))
    assert (known.hits, len(known)) == (2, 1)
    structural = [_placed(z, roll) for z, roll in ((0, 0), (1, 0), (0.2, 0), (0, "pi/2"), (0.2, "pi/2"))]
    for tree in structural:
        couple(tree, parts, known=known)
    assert (known.hits, len(known)) == (2, 1 + len(structural))


@pytest.mark.parametrize("bound", [{}, {"m": 0.7}, {"m": "2*{0}.m1 + m/3"}], ids=["free", "number", "expression"])
def test_names_of_instances_are_names_of_symbols_alone(bound: dict[str, Any]) -> None:
    """Formulas, certificate and all else are those of the slow way; others are names that sort otherwise."""
    arm, hand, known = shipped_part("planar-2r"), shipped_part("simple-pendulum"), Shapes()
    names = [
        ("arm", "hand"),
        ("b", "h1"),
        ("d", "l"),
        ("b", "h1"),
        ("c", "h"),
        ("arm", "hand"),
        ("h", "arm"),
        ("b", "u"),
    ]
    for first, second in names:
        given = {name: x.format(first) if isinstance(x, str) else x for name, x in bound.items()}
        tree = _tree(**given) | {"gravity": [0, f"-g*{second}.l/{first}.l1", "-g"]}
        tree["instances"][0]["name"] = first
        tree["instances"][1] |= {"name": second, "at": f"{first}.flange", "placement": {"position": [0, 0, 0.3]}}
        parts = {first: arm, second: hand}
        assert _said(couple(tree, parts, known=known)) == _said(couple(tree, parts))
    assert len([key for key in known if " " not in key]) == 3
    assert known.hits == 5 + 1  # five trees of the first shape, and one time a renamed program


@pytest.mark.parametrize(
    ("changed", "code"),
    [
        ({"name": "g"}, "reserved-name"),
        ({"name": "world"}, "reserved-name"),
        ({"name": "p"}, "duplicate-name"),
        ({"parameters": {"m": {"value": 1, "unit": "m"}}}, "unit-mismatch"),
        ({"parameters": {"m": {"value": "2*(", "unit": ""}}}, "bad-expression"),
    ],
)
def test_a_tree_of_a_known_shape_is_read_all_the_same(changed: dict[str, Any], code: str) -> None:
    """What is wrong with a tree is what the slow way says, whether or not there was one of its shape before."""
    part, known = shipped_part("simple-pendulum"), Shapes()

    def coupled(given: dict[str, Any], shapes: Shapes | None) -> Model:
        """Two pendulums, of which the second is as given, with parameters of the tree."""
        own = {"g": {"value": 9.81, "unit": "m/s^2"}, "m": {"value": 1, "unit": "kg"}} | given.get("parameters", {})
        name = given.get("name", "q")
        second = {"name": name, "substructure": "x", "parameters": {"m": "m"}}
        instances = [{"name": "p", "substructure": "x"}, second]
        tree = {"name": "t", "gravity": [0, 0, "-g"], "parameters": own, "instances": instances}
        return couple(tree, dict.fromkeys(("p", name), part), known=shapes)

    coupled({}, known)
    faults = []
    for shapes in (known, None):
        with pytest.raises(InvalidDocument) as refused:
            coupled(changed, shapes)
        faults.append(refused.value.faults)
    assert faults[0] == faults[1]
    assert faults[0][0].code == code


def test_names_of_instances_that_mean_another_tree_belong_to_the_shape() -> None:
    """Other hosts, other instances in expressions, and names that loads have."""
    part, known = shipped_part("planar-2r"), Shapes()
    a, b, c = ({"name": name, "substructure": "x"} for name in "abc")
    at_a, at_b = {"at": "a.flange"}, {"at": "b.flange"}
    push = {"type": "force", "name": "a", "to": "a.flange", "vector": [1, 0, 0]}
    trees: list[dict[str, Any]] = [
        {"instances": [a, b | at_a, c | at_a]},
        {"instances": [a, b | at_a, c | at_b]},
        {"instances": [a, b | at_a | {"parameters": {"l1": "a.l1"}}, c | at_a]},
        {"instances": [a, b | at_a | {"parameters": {"l1": "c.l1"}}, c | at_a]},
        {"instances": [a, b | at_a, c | at_a], "loads": [push]},
    ]
    for tree in trees:
        couple({"name": "t", "gravity": [0, 0, -9.81], **tree}, dict.fromkeys("abc", part), known=known)
    assert (known.hits, len(known)) == (0, len(trees))


@pytest.mark.parametrize(("arm", "hand"), [("scara", "parallel-gripper"), ("planar-2r", "simple-pendulum")])
def test_gravity_that_is_not_the_usual_one_is_put_in_as_documents_say(arm: str, hand: str) -> None:
    """The moon and Mars; a mount that is tilted by two angles, one of them given in another unit."""
    parts, known = {"arm": shipped_part(arm), "hand": shipped_part(hand)}, Shapes()
    definitions = {name: part.definition for name, part in parts.items()}
    pairs = (["-1.62", "-3.71"], [["4.905", "-8.4957"], [{"value": 310, "unit": "cm/s^2"}, -9.3]])
    for first, *others in ([[0, 0, z] for z in pairs[0]], [[x, 0, z] for x, z in pairs[1]]):
        for gravity in (first, *others):
            spec = TreeSpec.read({**_tree(), "gravity": gravity})
            stored = couple_shape(spec, parts, known=known)
            assert stored.numbers.keys() == {
                f"world.gravity.{axis}" for axis, x in zip("xyz", gravity, strict=True) if x
            }
            model = stored.with_numbers()
            assert not stored.numbers.keys() & {*stored.parameters, *model.effective}
            certify_tree(spec, definitions, model.summary(), model.program)
            assert _said(model) == _said(couple(spec, parts))
    assert (known.hits, len(known)) == (2, 2)


def test_usual_gravity_belongs_to_the_shape() -> None:
    """So that nothing is to be put in; and what is no number does, as before."""
    parts = {"arm": shipped_part("planar-2r"), "hand": shipped_part("simple-pendulum")}
    for gravity in ([0, 0, -9.81], [0, "-9.80665", 0], [0, 0, "-g"], [0, "-g/2", "-g"], [0, 0, 0], [0, 1, 0]):
        assert couple_shape({**_tree(), "gravity": gravity}, parts).numbers == {}


def test_wrong_gravity_put_in_is_found() -> None:
    parts = {"arm": shipped_part("planar-2r"), "hand": shipped_part("simple-pendulum")}
    spec = TreeSpec.read({**_tree(), "gravity": [0, "-1.62", 0]})
    wrong = replace(couple_shape(spec, parts), numbers={"world.gravity.y": Fraction(-163, 100)}).with_numbers()
    with pytest.raises(VerificationFailed):
        certify_tree(spec, {name: part.definition for name, part in parts.items()}, wrong.summary(), wrong.program)


def test_a_wrong_place_put_in_is_found() -> None:
    parts = {"arm": shipped_part("planar-2r"), "hand": shipped_part("simple-pendulum")}
    spec = TreeSpec.read(_placed(0.2, 0.3))
    stored = couple_shape(spec, parts)
    wrong = replace(stored, numbers={**stored.numbers, "hand.rpy.x": Fraction(31, 100)}).with_numbers()
    with pytest.raises(VerificationFailed):
        certify_tree(spec, {name: part.definition for name, part in parts.items()}, wrong.summary(), wrong.program)


def test_where_numbers_cannot_be_put_in_the_tree_is_coupled_with_them() -> None:
    """1/(k - 2) at 2 is refused with its place, and at 3 it is a number."""
    document = _document("simple-pendulum")
    document["parameters"]["k"] = {"value": 5}
    document["loads"] = [{"type": "joint", "coordinate": "q1", "force": "q1/(k - 2)"}]
    part, known = derive(Definition.read(document)), Shapes()

    def tree(k: float) -> dict[str, Any]:
        """With the parameter bound."""
        return {"name": "t", "instances": [{"name": "p", "substructure": "x", "parameters": {"k": k}}]}

    assert couple_shape(tree(3), {"p": part}, known=known).numbers == {"p.k": 3}
    with pytest.raises(InvalidDocument, match="divides by zero") as raised:
        couple(tree(2), {"p": part}, known=known)
    assert raised.value.faults[0].pointer == "/instances/0/parameters"


def test_a_default_of_the_tree_is_a_value() -> None:
    parts, known = {"arm": shipped_part("planar-2r"), "hand": shipped_part("simple-pendulum")}, Shapes()
    for value in (9.81, 2, 1.62):
        tree = _tree()
        tree["parameters"]["g"]["value"] = value
        assert _said(couple(tree, parts, known=known)) == _said(couple(tree, parts))
    assert (known.hits, len(known)) == (2, 1)


def test_defaults_that_stand_in_formulas_too_change_nothing() -> None:
    """2 and 1/2 do: of equal numbers a graph keeps the first, but defaults are in none."""
    known = Shapes()
    for value in (0.123, 2, 0.5, 0.321):
        document = _document("planar-2r")
        for each in document["parameters"].values():
            each["value"] = value
        parts = {"arm": derive(Definition.read(document)), "hand": shipped_part("simple-pendulum")}
        assert _said(couple(_tree(), parts, known=known)) == _said(couple(_tree(), parts))
    assert (known.hits, len(known)) == (3, 1)


def test_a_wrong_number_is_told_of_its_tree_alone() -> None:
    source, known = np.random.default_rng(4), Shapes()
    told = []
    for mass in (0.7, -0.7, 0.8):
        document = _varied("planar-2r", source).definition.model_dump(exclude_defaults=True, by_alias=True)
        document["parameters"]["m1"]["value"] = mass
        parts = {"arm": derive(Definition.read(document)), "hand": shipped_part("simple-pendulum")}
        model = couple(_tree(), parts, known=known)
        told.append([x["code"] for x in model.certificate["warnings"]])
    assert ["negative-mass" in codes for codes in told] == [False, True, False]
    assert known.hits == 2


def test_a_part_with_wrong_formulas_has_no_shape_that_is_known() -> None:
    known, parts = Shapes(), {"arm": shipped_part("planar-2r"), "hand": shipped_part("simple-pendulum")}
    couple(_tree(), parts, known=known)
    found = damages(parts["arm"].program, np.random.default_rng(1))
    wrong = next(program for _, place, program in found if place.startswith("frame.position"))
    with pytest.raises(VerificationFailed, match="planar-2r"):
        couple(_tree(), parts | {"arm": replace(parts["arm"], program=wrong)}, known=known)
    assert (known.hits, len(known)) == (0, 1)


def test_a_certificate_that_needs_defaults_is_not_that_of_a_shape() -> None:
    """sqrt(k - 5) has no value at random ones of the order of one."""
    known = Shapes()
    for k in (7.25, 6.25, 1.25):
        document = _document("simple-pendulum")
        document["parameters"]["k"] = {"value": k}
        document["loads"] = [{"type": "joint", "coordinate": "q1", "force": "sqrt(k - 5)*q1'"}]
        part = derive(Definition.read(document))
        model = couple({"name": "t", "instances": [{"name": "p", "substructure": "x"}]}, {"p": part}, known=known)
        assert (model.certificate["direct_form"]["max_relative_error"]["forces"] is None) == (k < 5)
    assert not known


def test_notices_of_loads_of_the_tree_are_told_again() -> None:
    known, part = Shapes(), shipped_part("planar-2r")
    load = {"name": "x", "type": "spring", "from": "world", "to": "arm.flange", "stiffness": "2 + arm.q1^2"}
    tree = {"name": "t", "gravity": [0, 0, 0], "instances": [{"name": "arm", "substructure": "x"}], "loads": [load]}
    told = [couple(tree, {"arm": part}, known=known).certificate["warnings"] for _ in range(2)]
    assert known.hits == 1
    assert told[0] == told[1] != []


@pytest.mark.parametrize("words", ["sqrt(x)", "min(a, b) and atan2(y, x)"])
def test_words_do_not_change_a_certificate(words: str) -> None:
    plain, worded = _document("simple-pendulum"), _document("simple-pendulum")
    worded |= {"title": words, "description": words, "tags": ["sqrt"], "source": words, "license": words}
    for each in worded["parameters"].values():
        each["description"] = words
    part, other = (derive(Definition.read(document)) for document in (plain, worded))
    assert part.certificate["states"] == other.certificate["states"] == 1
    tree = {"name": "t", "parameters": {"h": {"value": 1, "description": words}}}
    tree["instances"] = [{"name": "p", "definition": worded, "parameters": {"m": "h"}}]
    assert couple(tree, {"p": other}).certificate["states"] == 1
