"""Definitions that cannot be used: every fault has a pointer to its field and names the culprit."""

from __future__ import annotations

from decimal import Decimal
from typing import Any

import pytest
from bad_documents import GOOD, Path, Plain, cell, changed, pointer_of, request

from substructures import Definition, InvalidDocument, TooLarge, TreeSpec, couple, derive
from substructures.mechanics.formula_size import entries_of
from substructures.quantities.numbers.evaluation import evaluate

B: Path = ("bodies", 1)
J: Path = ("bodies", 0, "joint")
COINCIDENT = {"type": "spring", "from": {"body": "b1"}, "to": {"body": "b1"}, "stiffness": 1}
DEEP = "(" * 70 + "1" + ")" * 70
BUSHING = {"type": "bushing", "from": "b1", "to": "tip"}
PUSH = {"type": "force", "from": "b1", "to": "tip", "vector": [0, 0, 1]}
RUB = {"type": "friction", "coordinate": "s", "coulomb": 1, "velocity": 0.1}

#: (what, path of the fault, value put there, code, culprit named in the message)
DEFINITIONS: list[tuple[str, Path, Any, str, str]] = [
    ("unknown parent", (*B, "parent"), "b9", "unknown-parent", "b9"),
    ("its own parent", (*B, "parent"), "b2", "cycle", "b2"),
    ("duplicate body", (*B, "name"), "b1", "duplicate-name", "b1"),
    ("body named base", (*B, "name"), "base", "duplicate-name", "base"),
    ("illegal body name", (*B, "name"), "b 2; drop", "string-pattern-mismatch", "b 2; drop"),
    ("illegal name with newline", (*B, "name"), "b2\n", "string-pattern-mismatch", "b2"),
    ("too long name", (*B, "name"), "b" * 65, "string-pattern-mismatch", "bbb"),
    ("illegal library name", ("name",), "Good", "string-pattern-mismatch", "Good"),
    ("reserved parameter", ("parameters", "pi"), {"value": 3}, "reserved-name", "pi"),
    ("input that is a parameter", ("inputs", "l"), {}, "duplicate-name", "l"),
    ("duplicate port", ("ports", 1), {"name": "tip", "body": "b1"}, "duplicate-name", "tip"),
    ("port named as a body", ("ports", 0, "name"), "b2", "duplicate-name", "b2"),
    ("port on unknown body", ("ports", 0, "body"), "b9", "unknown-body", "b9"),
    ("coordinate twice", ("bodies", 2, "joint", "coordinate"), "q1", "duplicate-name", "q1"),
    ("coordinate named as a parameter", (*J, "coordinate"), "l", "duplicate-name", "l"),
    ("reserved coordinate", (*J, "coordinate"), "sin", "reserved-name", "sin"),
    ("coordinates of a compound joint", (*B, "joint", "coordinate"), ["x", "y"], "wrong-length", "planar"),
    ("unknown joint type", (*J, "type"), "hinge", "literal-error", "hinge"),
    ("unknown field", (*B, "weight"), 3, "extra-forbidden", "weight"),
    ("vector of two", ("bodies", 0, "com"), [1, 2], "missing", ""),
    ("vector of four", ("bodies", 0, "com"), [1, 2, 3, 4], "too-long", ""),
    ("unknown name", ("bodies", 0, "mass"), "free + mass9", "unknown-name", "mass9"),
    ("coordinate in a constant", (*J, "d"), "q1", "unknown-name", "q1"),
    ("velocity in a port", ("ports", 0, "position", 1), "q1'", "unknown-name", "q1'"),
    ("parameter in a default value", ("parameters", "l", "value"), "2*free", "unknown-name", "free"),
    ("expression that ends", (*J, "theta"), "pi/", "bad-expression", "column 4"),
    ("bad character", (*J, "theta"), "pi $ 2", "bad-expression", "column 4"),
    ("two operators", ("loads", 3, "force"), "2 * / s", "bad-expression", "column 5"),
    ("missing parenthesis", ("loads", 3, "force"), "sin(s", "bad-expression", "column 6"),
    ("empty expression", (*J, "d"), "", "bad-expression", "column 1"),
    ("division by zero", (*J, "d"), "1/0", "bad-expression", "division by zero"),
    ("division by what is zero", (*J, "d"), "1/(l - l)", "bad-expression", "division by zero"),
    ("division by zero in disguise", (*J, "d"), "1/(sin(l)^2 + cos(l)^2 - 1)", "bad-expression", "division by zero"),
    ("negative power of zero", (*J, "d"), "(l-l)^-1", "bad-expression", "division by zero"),
    ("tan at a pole", (*J, "d"), "tan(pi/2)", "bad-expression", "zero"),
    ("root of a negative number", (*J, "d"), "sqrt(-2)", "bad-expression", "-2"),
    ("exponent tower", (*J, "d"), "2^9^9", "bad-expression", "tower"),
    ("large exponent", (*J, "d"), "l^65", "bad-expression", "65"),
    ("tower in parentheses", (*J, "d"), "((9^64)^64)^64", "bad-expression", "limit"),
    ("no integer power of a negative number", (*J, "d"), "l*(-2)^0.5", "bad-expression", "integer"),
    ("exponent with a unit", (*J, "d"), "2^l", "unit-mismatch", "exponent"),
    ("long number", (*J, "d"), "1" * 401, "bad-expression", "400"),
    ("number with a large exponent", (*J, "d"), Decimal("1e500"), "bad-number", "400"),
    ("nested parentheses", (*J, "d"), DEEP, "bad-expression", "64"),
    ("long expression", (*J, "d"), "+1" * 6000, "bad-expression", "10000"),
    ("attribute of Python", (*J, "d"), "__import__('os').system('true')", "bad-expression", "column"),
    ("dunder name", (*J, "d"), "__class__", "unknown-name", "__class__"),
    ("call of an unknown function", (*J, "d"), "exec(1)", "unknown-name", "exec"),
    ("not a number", (*J, "d"), float("nan"), "number-not-finite", ""),
    ("infinity", ("bodies", 1, "mass"), float("inf"), "number-not-finite", ""),
    ("infinite decimal", ("bodies", 1, "mass"), Decimal("-Infinity"), "number-not-finite", ""),
    ("a truth value", ("bodies", 1, "mass"), True, "number-expected", ""),
    ("a list for a number", ("bodies", 1, "mass"), [1], "number-expected", ""),
    ("negative mass", ("bodies", 1, "mass"), -2, "negative-mass", "b2"),
    ("negative mass by a formula", ("bodies", 1, "mass"), "1 - 2", "negative-mass", "b2"),
    ("mass beyond all doubles", ("bodies", 1, "mass"), "(10^62)^5", "number-not-finite", "b2"),
    ("limits of no coordinate", (*J, "limits"), [[-1, 1], [0, 2]], "wrong-length", "2 pairs of limits"),
    ("negative rotor", (*J, "armature"), "-1/8", "negative-armature", "-0.125 kg m^2"),
    ("negative rotor of a slide", ("bodies", 2, "joint", "armature"), -2, "negative-armature", "-2 kg is negative"),
    ("zero joint axis", ("bodies", 2, "joint", "axis"), [0, 0, 0], "bad-axis", ""),
    ("joint axis without a value", ("bodies", 2, "joint", "axis"), ["log(0)", 0, 1], "bad-axis", ""),
    ("joint axis with a parameter", ("bodies", 2, "joint", "axis"), ["l", 0, 0], "unknown-name", "l"),
    ("axis without a placement", (*J, "axis"), [1, 0, 0], "axis-without-placement", "a placement, {} where"),
    ("row and placement", (*J, "placement"), {"position": [0, 0, 0]}, "row-and-placement", "placement"),
    ("offset of a compound joint", (*B, "joint", "phi"), 1, "offset-of-compound", "planar"),
    ("stops without limits", (*B, "joint", "limits_act"), {"stiffness": 1}, "stops-without-limits", "limits"),
    ("stops of a compound joint", (*B, "joint", "limits_act"), [{"stiffness": 1}], "wrong-length", "coordinates"),
    ("rotor that depends on the state", (*J, "armature"), "q1^2", "unknown-name", "q1"),
    ("laws of a compound joint", (*B, "joint", "damping"), [1, 2], "wrong-length", "coordinates"),
    ("law of a fixed joint", (*J,), {"type": "fixed", "stiffness": 1}, "law-of-fixed", "stiffness"),
    ("unreadable offset of a fixed joint", (*J,), {"type": "fixed", "phi": "1/0"}, "bad-expression", "zero"),
    ("ends of a spring in one point", ("loads", 2), COINCIDENT, "coincident-ends", "point"),
    ("load on unknown body", ("loads", 0, "body"), "b9", "unknown-body", "b9"),
    ("spring to unknown body", ("loads", 2, "to", "body"), "b9", "unknown-body", "b9"),
    ("joint load on unknown coordinate", ("loads", 3, "coordinate"), "q9", "unknown-coordinate", "q9"),
    ("load by an unknown input", ("loads", 0, "vector", 2), "u9", "unknown-name", "u9"),
    (
        "bushing from an unknown frame",
        ("loads", 4),
        {**BUSHING, "from": "b9"},
        "unknown-frame",
        "base, b1, b2, b3, tip",
    ),
    ("bushing to a misspelt frame", ("loads", 4), {**BUSHING, "to": "tipp"}, "unknown-frame", "did you mean 'tip'"),
    (
        "bushing with a wrong unit",
        ("loads", 4),
        {**BUSHING, "stiffness": [0, {"value": 1, "unit": "N"}, 0]},
        "unit-mismatch",
        "found 1 N",
    ),
    (
        "bushing with a length for an angle",
        ("loads", 4),
        {**BUSHING, "angular_stiffness": [0, "u", 0]},
        "unit-mismatch",
        "u",
    ),
    ("force to an unknown frame", ("loads", 4), {**PUSH, "to": "b9"}, "unknown-frame", "b9"),
    ("force on a body and between two", ("loads", 4), {**PUSH, "body": "b1"}, "extra-forbidden", "body"),
    ("force in axes of neither", ("loads", 4), {**PUSH, "axes": "body"}, "literal-error", "body"),
    ("force without a vector", ("loads", 4), {"type": "force", "to": "tip"}, "missing", "vector"),
    ("torque from nowhere", ("loads", 4), {"type": "torque", "from": "b1", "vector": [0, 0, 1]}, "missing", "to"),
    ("law by an unknown frame", ("loads", 3, "force"), "distance(b1, b9)", "unknown-frame", "b9"),
    ("distance of one point", ("loads", 3, "force"), "distance(b1, b1)", "coincident-ends", "distance(b1, b1)"),
    ("angle without a common axis", ("loads", 3, "force"), "angle(base, b2)", "no-common-axis", "angle(base, b2)"),
    (
        "rate of a distance in a potential",
        ("loads", 3),
        {"type": "potential", "potential": "distance'(b1, tip)^2*u"},
        "velocity-in-potential",
        "distance'(b1, tip)",
    ),
    ("measure in a joint", (*J, "stiffness"), "distance(b1, tip)", "unknown-name", "stand in loads"),
    ("friction on an unknown coordinate", ("loads", 4), {**RUB, "coordinate": "ss"}, "unknown-coordinate", "mean 's'"),
    ("friction that is negative", ("loads", 4), {**RUB, "coulomb": -1}, "bad-friction", "coulomb"),
    (
        "friction with a wrong unit",
        ("loads", 4),
        {**RUB, "velocity": {"value": 1, "unit": "rad/s"}},
        "unit-mismatch",
        "rad",
    ),
    ("friction by a coordinate", ("loads", 4), {**RUB, "coulomb": "s"}, "unknown-name", "'s'"),
    ("unknown load type", ("loads", 1, "type"), "magnet", "union-tag-invalid", "magnet"),
    ("missing vector", ("loads", 1, "vector"), ..., "missing", ""),
    ("missing parent", (*B, "parent"), ..., "missing", ""),
    ("limits of the wrong kind", (*J, "limits"), ["low", 1], "unknown-name", "low"),
]


def test_one_friction_on_a_coordinate() -> None:
    rubbed = {"coulomb": 1, "velocity": 0.1}
    for more in ((("loads", 4), RUB), (("bodies", 2, "joint", "friction"), rubbed)):
        with pytest.raises(InvalidDocument) as raised:
            derive(Definition.read(changed(GOOD, more, (("loads", 4 + ("loads" in more[0])), RUB))))
        (fault,) = raised.value.faults
        assert (fault.code, "'s' has friction already" in fault.message) == ("several-frictions", True)


@pytest.mark.parametrize(
    ("path", "value", "code", "culprit"), [d[1:] for d in DEFINITIONS], ids=[d[0] for d in DEFINITIONS]
)
def test_definition_with_a_fault(path: Path, value: Any, code: str, culprit: str) -> None:
    with pytest.raises(InvalidDocument) as raised:
        derive(Definition.read(changed(GOOD, (path, value))))
    faults = raised.value.faults
    near = [f for f in faults if f.pointer.startswith(pointer_of(path))]
    assert near, faults
    assert code in {f.code for f in near}, faults
    assert any(culprit in f.message for f in near), faults
    assert len(set(faults)) == len(faults)


def test_the_good_ones_are_good() -> None:
    model = cell()
    assert model.dof == 10
    assert evaluate(model, **request()).failures == ()


def test_a_parent_cycle_names_everyone_on_it() -> None:
    with pytest.raises(InvalidDocument) as raised:
        derive(Definition.read(changed(GOOD, (("bodies", 0, "parent"), "b3"))))
    assert [(f.pointer, f.code) for f in raised.value.faults] == [(f"/bodies/{i}/parent", "cycle") for i in range(3)]
    assert all(f"'b{i + 1}'" in f.message for i, f in enumerate(raised.value.faults))


def test_a_name_that_is_there_twice_is_no_cycle() -> None:
    """Neither of the bodies behind it, nor of others, in whatever order they come."""
    names = [("c", "b"), ("b", "base"), ("b", "base"), ("d", "base"), ("e", "d"), ("f", "c")]
    bodies = [{"name": name, "parent": parent, "joint": {"type": "fixed"}} for name, parent in names]
    with pytest.raises(InvalidDocument) as raised:
        derive(Definition.read({"name": "twice", "bodies": bodies}))
    assert [(f.pointer, f.code) for f in raised.value.faults] == [("/bodies/2/name", "duplicate-name")]


def test_all_faults_are_reported_together() -> None:
    bad = changed(GOOD, ((*J, "d"), "a+b9"), (("ports", 0, "position", 0), "1/0"), (("bodies", 1, "mass"), "2 3"))
    with pytest.raises(InvalidDocument) as raised:
        derive(Definition.read(bad))
    assert {f.pointer for f in raised.value.faults} == {"/bodies/0/joint/d", "/ports/0/position/0", "/bodies/1/mass"}


IMPOSSIBLE = [{"xx": 1, "yy": 1, "zz": 2.5}, {"xx": 1, "yy": -1, "zz": 1}, {"xx": 1, "yy": 1, "zz": 1, "xy": 3}]


@pytest.mark.parametrize("inertia", IMPOSSIBLE)
@pytest.mark.parametrize("about", ["com", "origin"])
def test_an_inertia_that_no_body_can_have(inertia: Plain, about: str) -> None:
    """Triangle inequality of the principal moments about the mass centre."""
    bad = changed(GOOD, (("bodies", 1, "inertia"), inertia | {"about": about}))
    with pytest.raises(InvalidDocument) as raised:
        derive(Definition.read(bad))
    (fault,) = raised.value.faults
    assert (fault.pointer, fault.code) == ("/bodies/1/inertia", "impossible-inertia")
    assert "'b2'" in fault.message


def test_inertia_about_the_origin_too_small_for_the_mass_centre() -> None:
    bad = changed(
        GOOD,
        (("bodies", 1, "inertia"), {"xx": 1, "yy": 1, "zz": 1, "about": "origin"}),
        (("bodies", 1, "com"), [2, 0, 0]),
    )
    with pytest.raises(InvalidDocument, match="triangle inequality"):
        derive(Definition.read(bad))


def test_a_disc_and_a_rod_are_possible() -> None:
    for inertia in ({"xx": 1, "yy": 1, "zz": 2}, {"xx": 0, "yy": 1, "zz": 1}, {"xx": 0.1, "yy": 0.2, "zz": 0.3}):
        derive(Definition.read(changed(GOOD, (("bodies", 1, "inertia"), inertia))))


def test_parameters_with_impossible_defaults_are_a_warning() -> None:
    given = changed(GOOD, (("parameters", "free", "value"), -1), (("bodies", 0, "inertia", "zz"), "l*free*l"))
    warnings = derive(Definition.read(given)).certificate["warnings"]
    assert [(w["pointer"], w["code"]) for w in warnings] == [
        ("/bodies/0/mass", "negative-mass"),
        ("/bodies/0/inertia", "impossible-inertia"),
    ]
    assert all("'b1'" in w["message"] for w in warnings)


@pytest.mark.parametrize("limits", [[1, -1], ["a", "-a"], ["pi/2", "pi/4"]])
def test_reversed_limits_are_a_warning(limits: list[Any]) -> None:
    given = changed(GOOD, ((*J, "limits"), limits), (("parameters", "a"), {"value": 0.5, "unit": "rad"}))
    (told,) = (w for w in derive(Definition.read(given)).certificate["warnings"] if w["code"] == "limits-reversed")
    assert told["pointer"] == "/bodies/0/joint/limits"
    assert "'b1'" in told["message"]


def test_a_negative_rotor_is_told_in_the_unit_of_its_joint() -> None:
    """In trees, too, of one number for both joints of a cylindrical one and of a list."""
    for armature in ("2*j", ["2*j", "2*j"]):
        slide = {"name": "b", "parent": "base", "mass": 1, "joint": {"type": "cylindrical", "armature": armature}}
        part = derive({"name": "x", "parameters": {"j": {"value": -1}}, "bodies": [slide]})
        tree = {"name": "t", "gravity": [0, 0, -9], "instances": [{"name": "p", "substructure": "x"}]}
        for warnings in (part.certificate["warnings"], couple(tree, {"p": part}).certificate["warnings"]):
            told = [w["message"].rpartition("armature ")[2].split(" is ")[0] for w in warnings]
            assert told == ["-2 kg m^2", "-2 kg"]


def test_stored_limits_of_no_coordinate_are_a_warning() -> None:
    given = Definition.read(changed(GOOD, ((*J, "limits"), [[-1, 1], [0, 2]])))
    (told,) = derive(given, is_stored=True).certificate["warnings"]
    assert (told["pointer"], told["code"]) == ("/bodies/0/joint/limits", "wrong-length")


def test_a_definition_that_is_no_object() -> None:
    for data in ([], "x", 3, None):
        with pytest.raises(InvalidDocument) as raised:
            Definition.read(data)
        assert [(f.pointer, f.code) for f in raised.value.faults] == [("", "object-expected")]


def test_too_many_bodies() -> None:
    bodies = [{"name": f"b{i}", "parent": "base", "joint": {"type": "fixed"}} for i in range(501)]
    with pytest.raises(InvalidDocument) as raised:
        Definition.read({"name": "many", "bodies": bodies})
    assert [(f.pointer, f.code) for f in raised.value.faults] == [("/bodies", "too-long")]


def test_a_mechanism_too_large_to_derive() -> None:
    """A chain of 200 joints has n^2/2 elements of its metric: refused before anything is spent on it."""
    with pytest.raises(TooLarge) as raised:
        derive(Definition.read(long_chain(200)))
    assert raised.value.size == sum(range(201))
    assert "limit" in str(raised.value)


def test_what_counts_as_an_element_of_the_metric_and_as_a_christoffel_symbol() -> None:
    """a, and a and revolute b, on the path to c: a slide, on it a hinge that carries a slide, and one more hinge."""
    assert entries_of([(-1, 1)]) == (1, 0)
    assert entries_of([(-1, 1), (0, 0), (1, 1), (0, 0)]) == (1 + 2 + 3 + 2, 0 + 2 * 1 + 3 * 1 + 2 * 1)


def test_a_tree_too_large_to_couple() -> None:
    part = derive(Definition.read(long_chain(6)))
    at = ["world", *(f"i{k}.b5" for k in range(39))]
    instances = [{"name": f"i{k}", "substructure": "long", "at": place} for k, place in enumerate(at)]
    tree = TreeSpec.read({"name": "tower", "instances": instances})
    with pytest.raises(TooLarge) as raised:
        couple(tree, {instance.name: part for instance in tree.instances})
    assert raised.value.size == sum(range(241))


def long_chain(n: int) -> Plain:
    row = {"type": "revolute", "theta": 0.3, "d": 0.2, "tau": 0.1}
    bodies = [{"name": f"b{i}", "parent": f"b{i - 1}" if i else "base", "joint": row, "mass": 1} for i in range(n)]
    return {"name": "long", "bodies": bodies}
