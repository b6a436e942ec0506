"""Trees and requests that cannot be used: every fault has a pointer to its field and names the culprit."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from bad_documents import GOOD, TREE, Path, Plain, cell, changed, coupled, good, pointer_of, request

from substructures import Definition, InvalidDocument, MissingValue, TreeSpec, couple, derive
from substructures.certificate.numbers import Bindings
from substructures.documents.fields import LONGEST
from substructures.errors import InvalidArgument
from substructures.expr.syntax import MAX_LENGTH
from substructures.quantities.numbers.asked import check
from substructures.quantities.numbers.evaluation import EvaluationOptions, evaluate
from substructures.quantities.regressor import regressor
from substructures.quantities.sources import Sources

LOOP: Plain = {"name": "loop", "type": "pin", "from": "world", "to": "two.tip"}
INSTANCE: Path = ("instances", 1)
TREES: list[tuple[str, Path, Any, str, str]] = [
    ("unknown host", (*INSTANCE, "at"), "three.tip", "unknown-instance", "three"),
    ("unknown port", (*INSTANCE, "at"), "one.flange", "unknown-port", "flange"),
    ("mounted on itself", (*INSTANCE, "at"), "two.tip", "cycle", "two"),
    ("place without a port", (*INSTANCE, "at"), "one", "place", "one.tip"),
    ("malformed place", (*INSTANCE, "at"), "one tip", "string-pattern-mismatch", "one tip"),
    ("duplicate instance", (*INSTANCE, "name"), "one", "duplicate-name", "one"),
    ("illegal instance", (*INSTANCE, "name"), "two.x", "string-pattern-mismatch", "two.x"),
    ("reserved instance", (*INSTANCE, "name"), "world", "reserved-name", "world"),
    ("instance named as a parameter", (*INSTANCE, "name"), "g", "reserved-name", "g"),
    ("parameter named as the time", ("parameters", "t"), {"value": 3}, "reserved-name", "t"),
    ("parameter named as a number", ("parameters", "pi"), {"value": 3}, "reserved-name", "pi"),
    ("unknown parameter", (*INSTANCE, "parameters", "mass"), 3, "unknown-parameter", "mass"),
    ("binding with an unknown name", (*INSTANCE, "parameters", "l"), "2*three.l", "unknown-name", "three.l"),
    ("binding that does not parse", (*INSTANCE, "parameters", "l"), "2*(", "bad-expression", "column 4"),
    ("binding to itself", (*INSTANCE, "parameters", "l"), "2*two.l", "cycle", "two.l"),
    ("binding to a coordinate", (*INSTANCE, "parameters", "l"), "one.q1", "unknown-name", "one.q1"),
    ("binding that is not finite", (*INSTANCE, "parameters", "l"), float("inf"), "number-not-finite", ""),
    ("placement with an unknown name", (*INSTANCE, "placement"), {"position": [0, "h", 0]}, "unknown-name", "h"),
    ("gravity with an unknown name", ("gravity", 2), "-gg", "unknown-name", "gg"),
    ("gravity of two", ("gravity",), [0, 0], "missing", ""),
    ("division by a constant zero", ("gravity", 0), "g/0", "bad-expression", "division by zero"),
    ("no substructure", (*INSTANCE, "substructure"), ..., "one-source", "definition"),
    ("closure from the world", ("closures",), [LOOP], "string-pattern-mismatch", "'to' may be the 'world'"),
    ("malformed reference", (*INSTANCE, "substructure"), "../etc", "string-pattern-mismatch", "../etc"),
]


@pytest.mark.parametrize(("path", "value", "code", "culprit"), [t[1:] for t in TREES], ids=[t[0] for t in TREES])
def test_tree_with_a_fault(path: Path, value: Any, code: str, culprit: str) -> None:
    with pytest.raises(InvalidDocument) as raised:
        coupled(changed(TREE, (path, value)))
    faults = raised.value.faults
    # a missing alternative is a fault of the object that lacks it
    near = [f for f in faults if f.pointer.startswith(pointer_of(path if value is not ... else path[:-1]))]
    assert near, faults
    assert code in {f.code for f in near}, faults
    assert any(culprit in f.message for f in near), faults


def test_a_long_chain_of_bindings_is_no_cycle() -> None:
    slide = {"name": "b", "parent": "base", "joint": {"type": "prismatic"}, "mass": "l"}
    part = derive({"name": "x", "parameters": {"l": {"value": 1}}, "bodies": [slide]})
    last = {"name": "p0", "substructure": "x"}
    others = [
        {"name": f"p{k}", "substructure": "x", "parameters": {"l": f"p{k - 1}.l + 1"}} for k in reversed(range(1, 55))
    ]
    tree = {"name": "t", "instances": [*others, last]}
    assert couple(tree, {each["name"]: part for each in tree["instances"]}).dof == 55
    names = {f"p{k}": f"p{k - 1} + 1" for k in range(1, 3000)}
    assert Bindings({"p0": 1}, names)["p2999"] == 3000


def test_a_cycle_of_hosts() -> None:
    tree = TreeSpec.read(changed(TREE, (("instances", 0, "at"), "two.tip")))
    with pytest.raises(InvalidDocument) as raised:
        couple(tree, {"one": good(), "two": good()})
    assert sorted(f.pointer for f in raised.value.faults) == ["/instances/0/at", "/instances/1/at"]
    assert {f.code for f in raised.value.faults} == {"cycle"}


def test_a_binding_that_no_formula_needs_is_read_all_the_same() -> None:
    part = derive(Definition.read(changed(GOOD, (("parameters", "spare"), {"value": 1}))))
    tree = TreeSpec.read(changed(TREE, ((*INSTANCE, "parameters", "spare"), "2*(")))
    with pytest.raises(InvalidDocument) as raised:
        couple(tree, {"one": part, "two": part})
    assert [(f.pointer, f.code) for f in raised.value.faults] == [("/instances/1/parameters/spare", "bad-expression")]


def test_a_binding_that_makes_a_divisor_zero() -> None:
    part = derive(Definition.read(changed(GOOD, (("bodies", 0, "joint", "tau"), "1/l"))))
    tree = TreeSpec.read(changed(TREE, ((*INSTANCE, "parameters", "l"), 0)))
    instance = int(INSTANCE[1])
    for make in (couple, regressor):
        with pytest.raises(InvalidDocument) as raised:
            make(tree, {"one": part, "two": part})
        (fault,) = raised.value.faults
        assert (fault.pointer, fault.code) == (f"/instances/{instance}/parameters", "division-by-zero")
        assert f"'{TREE['instances'][instance]['name']}'" in fault.message


# --- requests


ZEROS = [[0] * 10] * 3

REQUESTS: list[tuple[str, Plain, str, str, str]] = [
    ("wrong length of q", {"q": [1, 2, 3]}, "/q", "wrong-length", "10"),
    ("wrong length of qd", {"qd": [[0] * 9]}, "/qd", "wrong-length", "10"),
    ("other number of states", {"q": [[0] * 10] * 3, "qd": [[0] * 10] * 2}, "/qd", "wrong-length", "3"),
    ("no states", {"q": None}, "/q", "missing", "q"),
    ("ragged states", {"q": [[0] * 10, [0]]}, "/q", "wrong-length", ""),
    ("text in a state", {"q": [0] * 9 + ["1"]}, "/q/9", "number-expected", "1"),
    ("nothing in a state", {"q": [0] * 9 + [None]}, "/q/9", "number-expected", "found null"),
    ("truth value in a state", {"q": [0] * 9 + [True]}, "/q/9", "number-expected", "True"),
    ("not a number", {"q": [0, float("nan")] + [0] * 8}, "/q/1", "number-not-finite", ""),
    ("infinity in an array", {"qd": np.full((1, 10), np.inf)}, "/qd/0/0", "number-not-finite", ""),
    ("an integer beyond all doubles", {"q": [10**400] + [0] * 9}, "/q", "", ""),
    ("unknown coordinate", {"q": {"one.q9": [0]}}, "/q/one.q9", "unknown-coordinate", "'one.q9'; did you mean 'one.q"),
    ("unknown parameter", {"parameters": {"one.l9": 1}}, "/parameters/one.l9", "unknown-parameter", "one.l9"),
    ("bound parameter", {"parameters": {"two.l": 1}}, "/parameters/two.l", "unknown-parameter", "two.l"),
    ("infinite parameter", {"parameters": {"one.l": float("inf")}}, "/parameters/one.l", "number-not-finite", ""),
    (
        "wrong length of a parameter",
        {"q": ZEROS, "parameters": {"one.l": [1, 2]}},
        "/parameters/one.l",
        "wrong-length",
        "",
    ),
    ("two numbers of velocities", {"qd": ZEROS, "qdd": ZEROS[:2]}, "/qdd", "wrong-length", "3"),
    ("times and velocities", {"qd": ZEROS, "t": [0, 1]}, "/t", "wrong-length", "3"),
    ("unknown input", {"inputs": {"one.u9": 1}}, "/inputs/one.u9", "unknown-input", "one.u9"),
    ("inputs that are no object", {"inputs": [1]}, "/inputs", "object-expected", ""),
    ("unknown quantity", {"quantities": ["mass"]}, "/quantities/0", "unknown-quantity", "mass"),
    ("no quantities", {"quantities": []}, "/quantities", "missing", ""),
    ("missing accelerations", {"quantities": ["inverse_dynamics"]}, "/qdd", "missing", "qdd"),
    ("time that is no number", {"t": "now"}, "/t", "number-expected", "now"),
]


@pytest.mark.parametrize(
    ("change", "pointer", "code", "culprit"), [r[1:] for r in REQUESTS], ids=[r[0] for r in REQUESTS]
)
def test_request_with_a_fault(change: Plain, pointer: str, code: str, culprit: str) -> None:
    with pytest.raises(InvalidArgument) as raised:
        evaluate(cell(), **request(**change))
    faults = [f for f in raised.value.faults if f.pointer == pointer]
    assert faults, raised.value.faults
    assert any(code in f.code and culprit in f.message for f in faults), faults
    with pytest.raises(InvalidArgument) as checked:
        check(Sources(cell()), **request(**change))
    assert checked.value.faults == raised.value.faults


def test_a_request_without_faults_is_checked() -> None:
    states = check(Sources(cell()), **request(q=ZEROS))
    assert (states.count, states.single) == (3, False)


def test_a_parameter_without_a_value_is_named() -> None:
    with pytest.raises(MissingValue) as raised:
        evaluate(cell(), **request(parameters={}))
    assert raised.value.name == "one.free"
    with pytest.raises(MissingValue, match=r"one\.free"):
        check(Sources(cell()), **request(parameters={}))


def test_too_many_states() -> None:
    with pytest.raises(InvalidArgument) as raised:
        evaluate(cell(), **request(q=np.zeros((11, 10)), qd=None), options=EvaluationOptions(limit=10))
    assert [(f.pointer, f.code) for f in raised.value.faults] == [("/q", "too-many-states")]


def test_a_result_that_is_not_finite_is_listed() -> None:
    """A spring whose ends meet has no direction: a value with advice, not an exception."""
    spring = {"from": {"body": "base"}, "to": {"body": "b1"}, "type": "spring", "stiffness": 1, "length": 1}
    body = {"name": "b1", "parent": "base", "joint": {"type": "prismatic", "coordinate": "s"}, "mass": 1}
    part = derive(Definition.read({"name": "slide", "bodies": [body], "loads": [spring]}))
    spec = TreeSpec.read({"name": "t", "instances": [{"name": "x", "substructure": "slide"}]})
    answer = evaluate(couple(spec, {"x": part}), ["forces", "metric"], q=[[1.0], [0.0], [2.0]])
    assert [(f.state, f.quantity) for f in answer.failures] == [(1, "forces")]
    assert np.isfinite(answer["metric"]).all()


def test_a_singular_metric_is_a_failure_with_advice() -> None:
    body = {"name": "b1", "parent": "base", "joint": {"type": "revolute", "coordinate": "q"}}
    part = derive(Definition.read({"name": "none", "bodies": [body]}))
    spec = TreeSpec.read({"name": "t", "instances": [{"name": "x", "substructure": "none"}]})
    answer = evaluate(couple(spec, {"x": part}), ["forward_dynamics"], q=[0])
    assert answer.failures[0].state == 0
    assert "singular" in answer.failures[0].message


def rod(stiffness: str) -> Plain:
    ends = {"from": "world", "to": "two.tip", "to_at": [1, 0, 0]}
    return {**TREE, "loads": [{"name": "rod", "type": "spring", **ends, "stiffness": stiffness}]}


@pytest.mark.parametrize("stiffness", ["\u00c7", "k +", "2*("])
def test_a_spring_law_that_cannot_be_read_is_told(stiffness: str) -> None:
    with pytest.raises(InvalidDocument, match="/loads/0/stiffness: "):
        coupled(rod(stiffness))


def test_expressions_are_as_long_as_their_reader_takes() -> None:
    assert LONGEST == MAX_LENGTH
    with pytest.raises(InvalidDocument, match="an expression has at most 10000 characters"):
        TreeSpec.read(rod("1" * (MAX_LENGTH + 1)))
