"""Units in definitions and trees: converted exactly, checked against their places, and kept as they were given."""

from __future__ import annotations

from decimal import Decimal
from typing import Any

import numpy as np
import pytest
from bad_documents import GOOD, TREE, Path, changed

from substructures import Definition, InvalidDocument, TreeSpec, couple, derive, evaluate
from substructures.documents import read_json
from substructures.part.derive import recheck
from substructures.part.parameters import counted, uncounted
from substructures.part.part import Part

METRES: dict[str, Any] = {
    "name": "arm",
    "parameters": {
        "l": {"value": Decimal("1.2"), "unit": "m"},
        "tilt": {"value": "pi/6", "unit": "rad"},
        "k": {"value": 40, "unit": "N m/rad"},
    },
    "inputs": {"push": {"unit": "N"}},
    "bodies": [
        {
            "name": "link",
            "parent": "base",
            "joint": {
                "type": "revolute",
                "coordinate": "q",
                "theta": "tilt",
                "d": Decimal("0.3"),
                "stiffness": "k",
                "rest": "pi/4",
                "armature": Decimal("0.0005"),
                "limits": ["-pi/2", "pi/2"],
                "limits_act": {"stiffness": 500, "damping": 3},
            },
            "mass": Decimal("0.45359237"),
            "com": ["l/2", 0, 0],
            "inertia": {"xx": 0, "yy": Decimal("0.02"), "zz": Decimal("0.02")},
        },
        {
            "name": "slide",
            "parent": "link",
            "joint": {
                "type": "prismatic",
                "coordinate": "x",
                "tau": Decimal("0.25"),
                "damping": 120,
                "limits": [-1, 1],
                "limits_act": [{"stiffness": 2000, "damping": 7}],
            },
            "mass": 2,
        },
    ],
    "ports": [
        {"name": "tip", "body": "slide", "position": [0, 0, Decimal("0.01")], "rotation": {"rpy": [0, "pi/18", 0]}}
    ],
    "loads": [
        {"type": "force", "body": "slide", "at": [Decimal("0.02"), 0, 0], "vector": ["push", 1500, 0]},
        {"type": "torque", "body": "link", "vector": [0, 0, Decimal("0.7")]},
        {
            "type": "spring",
            "from": {"body": "base", "at": [0, 0, 1]},
            "to": {"body": "slide"},
            "stiffness": 3000,
            "damping": 4,
            "length": Decimal("0.4"),
        },
        {"type": "joint", "coordinate": "x", "force": "-3*x"},
        {"type": "potential", "potential": "k*q^2"},
        {"type": "potential", "potential": Decimal("2.5")},
    ],
}


def _of(value: Any, unit: str) -> dict[str, Any]:
    return {"value": value, "unit": unit}


#: every kind of place with a number in another unit that is exactly the one above
IN_OTHER_UNITS: tuple[tuple[Path, Any], ...] = (
    (("parameters", "l"), _of(1200, "mm")),
    (("parameters", "tilt"), _of(30, "deg")),
    (("parameters", "k"), {"value": _of(4000, "N cm/rad")}),
    (("bodies", 0, "joint", "d"), _of(30, "cm")),
    (("bodies", 0, "joint", "rest"), _of(45, "deg")),
    (("bodies", 0, "joint", "armature"), _of(5, "kg cm^2")),
    (("bodies", 0, "joint", "limits"), [_of(-90, "deg"), _of("90", "deg")]),
    (("bodies", 0, "joint", "limits_act", "stiffness"), _of(Decimal("0.5"), "kN m/rad")),
    (("bodies", 0, "joint", "limits_act", "damping"), _of(300, "N cm s/rad^2")),
    (("bodies", 0, "mass"), _of(1, "lb")),
    (("bodies", 0, "inertia", "yy"), _of(20_000, "kg mm^2")),
    (("bodies", 1, "joint", "tau"), _of("1/4", "m")),
    (("bodies", 1, "joint", "damping"), _of(Decimal("0.12"), "kN s/m")),
    (("bodies", 1, "joint", "limits_act", 0, "stiffness"), _of(2, "N/mm")),
    (("bodies", 1, "joint", "limits_act", 0, "damping"), _of(Decimal("0.007"), "kN s/m^2")),
    (("bodies", 1, "mass"), _of(Decimal("0.002"), "t")),
    (("ports", 0, "position"), [0, 0, _of(1, "cm")]),
    (("ports", 0, "rotation", "rpy"), [0, _of(10, "deg"), 0]),
    (("loads", 0, "at", 0), _of(20, "mm")),
    (("loads", 0, "vector", 1), _of(Decimal("1.5"), "kN")),
    (("loads", 1, "vector", 2), _of(70, "N cm")),
    (("loads", 2, "from", "at", 2), _of(1, "m")),
    (("loads", 2, "stiffness"), _of(3, "N/mm")),
    (("loads", 2, "damping"), _of(4, "kg/s")),
    (("loads", 2, "length"), _of(400, "mm")),
    (("loads", 5, "potential"), _of(Decimal("0.0025"), "kJ")),
)


def test_a_definition_in_any_units_has_the_formulas_of_that_in_si() -> None:
    plain, given = (derive(Definition.read(x)) for x in (METRES, changed(METRES, *IN_OTHER_UNITS)))
    assert given.program.digest == plain.program.digest
    assert given.parameters["l"] == plain.parameters["l"] | {"given": {"value": 1200, "unit": "mm"}}
    assert given.definition.digest != plain.definition.digest


def test_what_was_converted_is_told_both_ways() -> None:
    converted = derive(Definition.read(changed(METRES, *IN_OTHER_UNITS))).certificate["converted"]
    told = {each["pointer"]: (each["value"], each["unit"], each["si"], each["si_unit"]) for each in converted}
    assert told["/parameters/l/value"] == (1200, "mm", Decimal("1.2"), "m")
    assert told["/bodies/0/joint/limits/0"] == (-90, "deg", "-1/2*pi", "rad")
    assert told["/bodies/0/mass"] == (1, "lb", Decimal("0.45359237"), "kg")
    # not those in coherent units: 1/4 m, 1 m, 4 kg/s
    assert len(told) == len(IN_OTHER_UNITS) - 2


def test_definitions_in_other_units_are_read_again_as_they_are_stored() -> None:
    given = Definition.read(changed(METRES, *IN_OTHER_UNITS))
    stored = read_json(given.canonical())
    assert stored["parameters"]["l"] == {"value": {"value": 1200, "unit": "mm"}, "unit": "m"}
    assert Definition.stored(stored).digest == Definition.read(stored).digest == given.digest


CONTRADICTIONS: list[tuple[Path, Any, str]] = [
    (("bodies", 0, "mass"), _of(3, "furlong"), "/bodies/0/mass"),
    (("bodies", 0, "mass"), "l", "/bodies/0/mass"),
    (("bodies", 0, "mass"), "l/l", "/bodies/0/mass"),
    (("bodies", 0, "com", 1), "l*l", "/bodies/0/com/1"),
    (("bodies", 0, "com", 1), "l + k", "/bodies/0/com/1"),
    (("bodies", 0, "com", 1), "l*sin(l)", "/bodies/0/com/1"),
    (("bodies", 0, "inertia", "xx"), _of(1, "kg m"), "/bodies/0/inertia/xx"),
    (("bodies", 0, "joint", "d"), _of(1, "deg"), "/bodies/0/joint/d"),
    (("bodies", 0, "joint", "psi"), "l", "/bodies/0/joint/psi"),
    (("bodies", 0, "joint", "stiffness"), _of(1, "N/m"), "/bodies/0/joint/stiffness"),
    (("bodies", 1, "joint", "stiffness"), "k", "/bodies/1/joint/stiffness"),
    (("bodies", 1, "joint", "damping"), _of(1, "N m s/rad"), "/bodies/1/joint/damping"),
    (("bodies", 1, "joint", "armature"), _of(1, "kg m^2"), "/bodies/1/joint/armature"),
    (("bodies", 1, "joint", "rest"), _of(1, "deg"), "/bodies/1/joint/rest"),
    (("bodies", 1, "joint", "limits"), [_of(1, "deg"), 2], "/bodies/1/joint/limits/0"),
    (
        ("bodies", 0, "joint", "limits_act", "stiffness"),
        _of(1, "N/m"),
        "/bodies/0/joint/limits_act/stiffness",
    ),
    (
        ("bodies", 0, "joint", "limits_act", "damping"),
        _of(1, "N s/m"),
        "/bodies/0/joint/limits_act/damping",
    ),
    (
        ("bodies", 1, "joint", "limits_act", 0, "stiffness"),
        "k",
        "/bodies/1/joint/limits_act/0/stiffness",
    ),
    (
        ("bodies", 1, "joint", "limits_act", 0, "damping"),
        _of(1, "N s/m"),
        "/bodies/1/joint/limits_act/0/damping",
    ),
    (("ports", 0, "position", 0), _of(1, "s"), "/ports/0/position/0"),
    (("loads", 0, "at", 0), _of(1, "N"), "/loads/0/at/0"),
    (("loads", 0, "vector", 0), _of(1, "N m"), "/loads/0/vector/0"),
    (("loads", 1, "vector", 0), "push", "/loads/1/vector/0"),
    (("loads", 2, "stiffness"), "k", "/loads/2/stiffness"),
    (("loads", 2, "length"), _of(1, "kg"), "/loads/2/length"),
    (("loads", 3, "force"), _of(1, "N m"), "/loads/3/force"),
    (("loads", 4, "potential"), "k*l", "/loads/4/potential"),
    (("loads", 5, "potential"), _of(1, "N"), "/loads/5/potential"),
    (("parameters", "l"), {"value": _of(1, "kg"), "unit": "m"}, "/parameters/l/value"),
]


@pytest.mark.parametrize(("path", "value", "pointer"), CONTRADICTIONS)
def test_a_contradiction_is_refused_with_its_place(path: Path, value: Any, pointer: str) -> None:
    with pytest.raises(InvalidDocument) as raised:
        derive(Definition.read(changed(METRES, (path, value))))
    assert [(fault.pointer, fault.code) for fault in raised.value.faults] == [(pointer, "unit-mismatch")]


@pytest.mark.parametrize(
    ("path", "value", "pointer", "code"),
    [
        (("bodies", 0, "mass"), _of(3, "furlogs"), "/bodies/0/mass", "unknown-unit"),
        (("parameters", "l", "unit"), "metre stick", "/parameters/l/unit", "unknown-unit"),
        (("inputs", "push", "unit"), "newtonian", "/inputs/push/unit", "unknown-unit"),
        (("bodies", 0, "mass"), {"value": 3}, "/bodies/0/mass", "number-expected"),
        (("bodies", 0, "mass"), {"value": True, "unit": "kg"}, "/bodies/0/mass", "number-expected"),
        (("bodies", 0, "mass"), {"value": 3, "unit": 5}, "/bodies/0/mass", "number-expected"),
        (("bodies", 0, "mass"), _of("2*l", "kg"), "/bodies/0/mass", "unit-of-expression"),
        (("bodies", 0, "joint", "d"), _of("1/0", "mm"), "/bodies/0/joint/d", "bad-expression"),
    ],
)
def test_units_that_cannot_be_read_are_refused(path: Path, value: Any, pointer: str, code: str) -> None:
    with pytest.raises(InvalidDocument) as raised:
        derive(Definition.read(changed(METRES, (path, value))))
    assert (pointer, code) in [(fault.pointer, fault.code) for fault in raised.value.faults]


def test_numbers_that_would_need_units_are_a_warning() -> None:
    given = changed(METRES, (("bodies", 0, "mass"), "7850*l^3"), (("loads", 3, "force"), "-9.81*l"))
    warnings = derive(Definition.read(given)).certificate["warnings"]
    assert [(w["pointer"], w["code"]) for w in warnings] == [("/bodies/0/mass", "unit-doubtful")]


def test_what_no_formula_depends_on_is_a_warning() -> None:
    names = {name: {"value": 1} for name in ("unused", "lowest")}
    given = changed(METRES, (("parameters",), METRES["parameters"] | names), (("inputs", "idle"), {}))
    given = changed(given, (("bodies", 1, "joint", "limits"), ["-lowest", "lowest"]))
    warnings = derive(Definition.read(given)).certificate["warnings"]
    assert [(w["pointer"], w["code"]) for w in warnings] == [
        ("/parameters/unused", "no-effect"),
        ("/inputs/idle", "no-effect"),
    ]


def test_definitions_of_old_keep_their_meaning() -> None:
    """Units were texts: 1200 with the unit mm was 1200 m, and furlongs per fortnight were welcome."""
    old = changed(METRES, (("parameters", "l"), _of(1200, "mm")), (("parameters", "k", "unit"), "stiff ones"))
    stored = Definition.stored(old)
    assert read_json(stored.canonical())["parameters"]["l"] == _of(1200, "mm")
    part = Part.load(stored, derive(Definition.read(METRES)).program.to_bytes(), {})
    assert (part.parameters["l"]["value"], part.parameters["l"]["unit"]) == (1200, "mm")
    model = couple(TreeSpec.read({"name": "t", "instances": [{"name": "a", "substructure": "arm"}]}), {"a": part})
    assert model.parameters["a.l"]["value"] == 1200
    assert [w["pointer"] for w in uncounted(part.parameters)] == ["/parameters/l/unit", "/parameters/k/unit"]
    # and in a document of today they say what they meant
    today = derive(Definition.read(counted(read_json(stored.canonical()))))
    assert today.parameters["l"] == {"value": 1200, "unit": "", "description": "[mm]"}


def _tree(**changes: Any) -> dict[str, Any]:
    instance = {"name": "a", "substructure": "arm", "placement": {"position": [0, 0, 1]}, "parameters": {"l": 2}}
    tree = {"name": "t", "gravity": [0, 0, "-g"], "parameters": {"g": _of(Decimal("9.81"), "m/s^2")}}
    return {**tree, "instances": [instance | changes.pop("instance", {})], **changes}


@pytest.mark.parametrize(
    ("tree", "pointer"),
    [
        (_tree(gravity=[0, 0, _of(-1, "N")]), "/gravity/2"),
        (_tree(gravity=[0, 0, "a.l"]), "/gravity/2"),
        (_tree(instance={"parameters": {"l": _of(2, "kg")}}), "/instances/0/parameters/l"),
        (_tree(instance={"parameters": {"l": "g"}}), "/instances/0/parameters/l"),
        (_tree(instance={"placement": {"position": [_of(1, "deg"), 0, 0]}}), "/instances/0/placement/position/0"),
        (_tree(instance={"placement": {"rpy": [0, "a.l", 0]}}), "/instances/0/placement/rpy/1"),
        (_tree(closures=[{"name": "c", "type": "rod", "from": "a.tip", "length": "g"}]), "/closures/0/length"),
        (_tree(parameters={"g": {"value": _of(1, "N"), "unit": "m/s^2"}}), "/parameters/g/value"),
    ],
)
def test_contradictions_in_trees_are_refused(tree: dict[str, Any], pointer: str) -> None:
    part = derive(Definition.read(METRES))
    with pytest.raises(InvalidDocument) as raised:
        couple(TreeSpec.read(tree), {"a": part})
    assert [(fault.pointer, fault.code) for fault in raised.value.faults] == [(pointer, "unit-mismatch")]


def test_a_tree_in_any_units_has_the_formulas_of_that_in_si() -> None:
    part = derive(Definition.read(METRES))
    plain = _tree(closures=[{"name": "c", "type": "rod", "from": "a.tip", "length": 2}])
    given = _tree(
        parameters={"g": _of(981, "cm/s^2")},
        instance={"parameters": {"l": _of(2000, "mm")}, "placement": {"position": [0, 0, _of(100, "cm")]}},
        closures=[{"name": "c", "type": "rod", "from": "a.tip", "length": _of(2, "m")}],
    )
    first, second = (couple(TreeSpec.read(x), {"a": part}) for x in (plain, given))
    assert first.program.digest == second.program.digest
    numbers = [evaluate(model, "forces", q=[0.3, 0.1])["forces"] for model in (first, second)]
    assert np.array_equal(*numbers)


def test_the_documents_of_the_other_tests_have_no_contradictions() -> None:
    part = derive(Definition.read(GOOD))
    couple(TreeSpec.read(TREE), {"one": part, "two": part})


def test_verifying_a_part_of_old_tells_what_its_units_say() -> None:
    old = changed(METRES, (("parameters", "l"), _of(Decimal("1.2"), "mm")), (("bodies", 0, "mass"), "l"))
    massive = derive(Definition.read(changed(METRES, (("parameters", "l", "unit"), ""), (("bodies", 0, "mass"), "l"))))
    certificate = recheck(Part.load(Definition.stored(old), massive.program.to_bytes(), {}))
    assert [(w["pointer"], w["code"]) for w in certificate["warnings"]] == [
        ("/bodies/0/mass", "unit-mismatch"),
        ("/parameters/l/unit", "unit-not-counted"),
    ]


def test_names_that_read_as_a_value_with_a_unit() -> None:
    """Coordinates and parameters may be called so: what is given by their names is no value with a unit."""
    joint = {"type": "revolute", "coordinate": "value"}
    slide = {"type": "prismatic", "coordinate": "unit"}
    bodies = [
        {"name": "a", "parent": "base", "joint": joint, "mass": 1, "com": [1, 0, 0]},
        {"name": "b", "parent": "a", "joint": slide, "mass": 1},
    ]
    poses = {"home": {"value": 1, "unit": 2}}
    derive({"name": "x", "bodies": bodies, "poses": poses})
    one = [{"name": "a", "parent": "base", "joint": {"type": "revolute"}, "mass": "value", "com": ["unit", 0, 0]}]
    part = derive({"name": "x", "parameters": {"value": {"value": 1}, "unit": {"value": 1}}, "bodies": one})
    bound = {"name": "p", "substructure": "x", "parameters": {"value": "m", "unit": "l"}}
    tree = {"name": "t", "gravity": [0, 0, -9], "parameters": {"m": {}, "l": {}}, "instances": [bound]}
    assert set(couple(tree, {"p": part}).parameters) == {"m", "l"}
