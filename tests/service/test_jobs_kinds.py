"""Kinds of jobs: items compute what the library computes; what cannot be resolved is refused with a pointer."""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from service.arrays import read_npz
from service.arrow import read_tables
from service.jobs.engine import Outcome
from service.jobs.kinds import KINDS, expand, run
from service.jobs.kinds.states import DRAWS, sample_states
from service.settings import Limits
from service.summaries import PartContent, part_content
from substructures.documents import read_json, write_json
from substructures.errors import InvalidDocument
from substructures.evaluation import evaluate
from substructures.model import Model, couple
from substructures.part import derive
from substructures.printers import render
from substructures.tree import TreeSpec

from .conftest import HAND, PENDULUM, SLIDER, TREE
from .jobs_library import MemoryLibrary

LIMITED: dict[str, Any] = {
    **SLIDER,
    "name": "limited",
    "bodies": [{**SLIDER["bodies"][0], "joint": {"type": "prismatic", "coordinate": "x", "limits": ["-1/4", 2]}}],
}
FREE: dict[str, Any] = {"name": "free", "instances": [{"name": "a", "substructure": "slider"}]}
BOUNDED: dict[str, Any] = {
    "name": "bounded",
    "instances": [
        {"name": "a", "substructure": "limited"},
        {"name": "p", "substructure": "pendulum", "at": "a.top"},
    ],
}


@pytest.fixture(scope="module")
def library() -> MemoryLibrary:
    return MemoryLibrary([PENDULUM, SLIDER, LIMITED], [TREE, FREE, BOUNDED])


def quiet(_fraction: float) -> None:
    """Nobody listens."""


def outcomes(
    library: MemoryLibrary, kind: str, request: Mapping[str, Any], limits: Limits | None = None
) -> list[Outcome]:
    """What comes of a submission; items pass through their stored form."""
    items = [read_json(write_json(item)) for item in library.items(kind, request, limits)]
    return [run(kind, item, library.blobs, quiet) for item in items]


def faults(library: MemoryLibrary, kind: str, request: Mapping[str, Any], limits: Limits | None = None) -> set[Any]:
    """Pointer and code of what is wrong with a submission."""
    with pytest.raises(InvalidDocument) as caught:
        library.items(kind, request, limits)
    return {(fault.pointer, fault.code) for fault in caught.value.faults}


def test_assemble_gives_what_coupling_gives(library: MemoryLibrary) -> None:
    tree = {**TREE, "instances": [*TREE["instances"], HAND]}
    (outcome,) = outcomes(library, "assemble", {"items": [tree]})
    spec = TreeSpec.read(read_json(outcome.files["spec"]))
    model = couple(spec, dict.fromkeys(("arm", "hand"), library.parts["pendulum"]))
    assert outcome.problem is None
    assert outcome.files["program"] == model.program.to_bytes()
    assert outcome.summary["program"] == model.program.digest
    assert outcome.summary["digest"] == spec.digest
    digest = library.parts["pendulum"].definition.digest
    assert {i.substructure for i in spec.instances} == {f"pendulum@{digest}"}
    assert outcome.summary["parts"] == {"arm": digest, "hand": digest}
    stored = Model.load(read_json(outcome.files["summary"]), outcome.files["program"])
    assert stored.coordinates == model.coordinates


def test_assemble_brings_inline_definitions_along(library: MemoryLibrary) -> None:
    inline = {"name": "x", "definition": {**SLIDER, "name": "mine"}, "at": "arm.tip"}
    (outcome,) = outcomes(library, "assemble", {"items": [{**TREE, "instances": [*TREE["instances"], inline]}]})
    part = derive(TreeSpec.read(read_json(outcome.files["spec"])).instances[1].definition or pytest.fail("inline"))
    content = PartContent.of_files(outcome.files, "x.")
    assert content.row["definition"].encode() == part.definition.canonical()
    assert content.program == part.program.to_bytes()
    assert outcome.summary["parts"]["x"] == part.definition.digest


def test_equal_items_are_equal_whatever_reference_is_used(library: MemoryLibrary) -> None:
    digest = library.parts["pendulum"].definition.digest
    given = [
        {**TREE, "instances": [{**TREE["instances"][0], "substructure": s}]} for s in ("pendulum", f"pendulum@{digest}")
    ]
    first, second = library.items("assemble", {"items": given})
    assert write_json(first) == write_json(second)


def test_template_gives_every_combination_with_names(library: MemoryLibrary) -> None:
    tree = {**TREE, "instances": [*TREE["instances"], HAND]}
    choices = {"hand": ["pendulum", "limited"], "arm.l": [1, "1.5"], "/parameters/g/value": [9.81]}
    items = expand("assemble", {"template": tree, "choices": choices}, Limits(), library)
    names = ["cell-pendulum-1-9-81", "cell-pendulum-1-5-9-81", "cell-limited-1-9-81", "cell-limited-1-5-9-81"]
    assert [item["tree"]["name"] for item in items] == names
    assert [item["tree"]["instances"][0]["parameters"] for item in items] == [{"l": 1}, {"l": "1.5"}] * 2
    assert "parameters" not in tree["instances"][0]
    long = expand("assemble", {"template": {**tree, "name": "c" * 64}, "choices": {"arm.l": [1, 2]}}, Limits(), library)
    assert [item["tree"]["name"] for item in long] == ["c" * 62 + "-1", "c" * 62 + "-2"]


def test_derive_gives_what_deriving_gives(library: MemoryLibrary) -> None:
    (outcome,) = outcomes(library, "derive", {"items": [PENDULUM]})
    part = library.parts["pendulum"]
    content, expected = PartContent.of_files(outcome.files), part_content(part)
    timed = {"certificate": ""}
    assert {**content.row, **timed} == {**expected.row, **timed}
    assert [tuple(row) for row in content.formulas] == expected.formulas
    assert (content.program, content.nodes) == (expected.program, expected.nodes)
    assert (content.name, content.digest) == (part.name, part.definition.digest)
    assert outcome.summary["digest"] == part.definition.digest
    limits = Limits(job_nodes=20)
    (outcome,) = outcomes(library, "derive", {"items": [PENDULUM]}, limits)
    assert outcome.problem is not None
    assert (outcome.problem["code"], outcome.problem["limit"]) == ("too-large", 20)


def test_verify_makes_the_certificate_anew(library: MemoryLibrary) -> None:
    made = outcomes(library, "verify", {"items": [{"substructure": "*"}]})
    for outcome, part in zip(made, library.parts.values(), strict=True):
        certificate = read_json(outcome.files["certificate"])
        assert write_json(certificate["direct_form"]) == write_json(part.certificate["direct_form"])


def test_verify_finds_damaged_programs(library: MemoryLibrary) -> None:
    (item,) = library.items("verify", {"items": [{"substructure": "pendulum"}]})
    other = library.parts["slider"].program
    outcome = run("verify", item, {**library.blobs, item["program"]: b"{}"}, quiet)
    assert outcome.problem is not None
    assert outcome.problem["code"] == "damaged-program"
    wrong = {**item, "program": other.digest}
    outcome = run("verify", wrong, library.blobs, quiet)
    assert outcome.problem is not None


def test_export_prints_what_the_service_prints(library: MemoryLibrary) -> None:
    item = {"tree": "cell", "quantity": "metric", "format": "latex"}
    numbers = {**item, "format": "text", "form": "expanded", "bind": "defaults"}
    unknown = {**item, "quantity": "beauty"}
    first, second, third = outcomes(library, "export", {"items": [item, numbers, unknown]})
    tree = library.tree("cell")
    assert tree is not None
    model = Model.load(read_json(tree.summary.encode()), library.blobs[tree.program])
    assert first.files["text"].decode() == render(model.program.select(["metric"]), "latex")
    assert "= 11/5\n" in second.files["text"].decode()  # m l^2 + m l^2 / 10
    assert third.problem is not None
    assert third.problem["code"] == "unknown-quantity"


def evaluated(library: MemoryLibrary, name: str, request: Mapping[str, Any]) -> dict[str, Any]:
    tree = library.tree(name)
    assert tree is not None
    return evaluate(Model.load(read_json(tree.summary.encode()), library.blobs[tree.program]), request)


def joined(made: list[Outcome], name: str) -> Any:
    assert all(outcome.problem is None for outcome in made), made
    return np.concatenate([read_npz(io.BytesIO(outcome.files["result"]), 2**26)[name] for outcome in made])


def test_listed_states_are_split_and_nothing_else_changes(library: MemoryLibrary) -> None:
    q = [[0.1 * k] for k in range(7)]
    request = {
        "quantities": ["metric", "forces"],
        "q": q,
        "qd": [0.5],
        "parameters": {"arm.m": [1.0 + k for k in range(7)]},
        "t": 0,
    }
    made = outcomes(library, "evaluate", {"items": [{"tree": "cell", "request": request}]}, Limits(job_states=3))
    assert [outcome.summary["range"] for outcome in made] == [[0, 3], [3, 6], [6, 7]]
    expected = evaluated(library, "cell", request)
    assert np.array_equal(joined(made, "metric"), expected["metric"])
    assert np.array_equal(joined(made, "forces"), expected["forces"])
    by_name = {**request, "q": {"arm.q": [0.1 * k for k in range(7)]}}
    made = outcomes(library, "evaluate", {"items": [{"tree": "cell", "request": by_name}]}, Limits(job_states=3))
    assert np.array_equal(joined(made, "forces"), expected["forces"])


def test_arrow_says_what_npz_says(library: MemoryLibrary) -> None:
    pytest.importorskip("pyarrow")
    item = {
        "tree": "cell",
        "request": {"quantities": ["metric", "forward_dynamics", "kinematics"], "parameters": {"arm.m": [1, 0, 2]}},
        "grid": {"arm.q": [0.1, 0.2, 0.3]},
        "format": "arrow",
    }
    single = {"tree": "cell", "request": {"quantities": ["metric"], "q": [0.3]}, "format": "arrow"}
    both = outcomes(library, "evaluate", {"items": [item, {**item, "format": "npz"}, single]})
    assert [each.summary["media_type"].rpartition("/")[2] for each in both[:2]] == ["vnd.apache.arrow.stream", "x-npz"]
    (table,) = read_tables(io.BytesIO(both[0].files["result"]))
    arrays = read_npz(io.BytesIO(both[1].files["result"]), 2**20)
    assert np.array_equal(table["states.arm.q"], [0.1, 0.2, 0.3])
    for name in ("metric", "kinematics.position", "states.arm.q"):
        assert np.array_equal(table[name], arrays[name])
    assert [failure["state"] for failure in table["failures"]] == list(arrays["failures.state"])
    (row,) = read_tables(io.BytesIO(both[2].files["result"]))
    assert row["metric"].shape == (1, 1, 1)


def test_one_state_is_one_item(library: MemoryLibrary) -> None:
    request = {"quantities": ["metric"], "q": [0.3]}
    (outcome,) = outcomes(library, "evaluate", {"items": [{"tree": "cell", "request": request}]})
    assert read_npz(io.BytesIO(outcome.files["result"]), 2**20)["metric"].shape == (1, 1)


def test_grid_is_every_combination(library: MemoryLibrary) -> None:
    grid = {"arm.q": {"from": -1, "to": 1, "count": 5}, "arm.q'": [0, 2], "arm.m": [1, 3], "tau.arm.q": 7}
    item = {"tree": "cell", "request": {"quantities": ["forces", "kinetic_energy"]}, "grid": grid}
    made = outcomes(library, "evaluate", {"items": [item]}, Limits(job_states=6))
    assert len(made) == 4
    axes = np.meshgrid(np.linspace(-1, 1, 5), [0.0, 2.0], [1.0, 3.0], [7.0], indexing="ij")
    q, rate, mass, torque = (axis.ravel() for axis in axes)
    request = {
        "quantities": ["forces", "kinetic_energy"],
        "q": {"arm.q": q},
        "qd": {"arm.q": rate},
        "parameters": {"arm.m": mass},
        "inputs": {"tau.arm.q": torque},
    }
    expected = evaluated(library, "cell", request)
    assert np.array_equal(joined(made, "forces"), expected["forces"])
    assert np.array_equal(joined(made, "kinetic_energy"), expected["kinetic_energy"])
    assert np.array_equal(joined(made, "states.arm.m"), mass)


def test_sample_does_not_depend_on_how_it_is_split(library: MemoryLibrary) -> None:
    item = {
        "tree": "bounded",
        "request": {"quantities": ["metric"]},
        "sample": {"count": 50, "seed": 3, "ranges": {"p.q'": [1, 2]}},
    }
    whole = outcomes(library, "evaluate", {"items": [item]})
    split = outcomes(library, "evaluate", {"items": [item]}, Limits(job_states=7))
    assert (len(whole), len(split)) == (1, 8)
    for name in ("metric", "states.a.x", "states.p.q", "states.p.q'"):
        assert np.array_equal(joined(whole, name), joined(split, name)), name
    x, angle, rate = (joined(whole, f"states.{name}") for name in ("a.x", "p.q", "p.q'"))
    assert -0.25 <= x.min() < 0.2 < 1.5 < x.max() <= 2  # the joint limits
    assert -np.pi <= angle.min() < -2 < 2 < angle.max() <= np.pi
    assert 1 <= rate.min() < rate.max() <= 2


@pytest.mark.parametrize("columns", [1, DRAWS, DRAWS + 1])
def test_any_part_of_a_sample_can_be_made_alone(columns: int) -> None:
    sample = {"seed": 5, "ranges": {f"x{k}": [0, 1] for k in range(columns)}}
    whole = sample_states(sample, 0, 100)
    part = sample_states(sample, 41, 67)
    assert all(np.array_equal(whole[name][41:67], part[name]) for name in whole)
    everything = np.concatenate(list(whole.values()))
    assert len(np.unique(everything)) == len(everything)


def test_compiled_items_agree_with_interpreted_ones(library: MemoryLibrary) -> None:
    item = {"tree": "bounded", "request": {"quantities": ["metric", "christoffel"]}, "sample": {"count": 3000}}
    compiled = outcomes(library, "evaluate", {"items": [item]})
    interpreted = outcomes(library, "evaluate", {"items": [item]}, Limits(job_states=500))
    for name in ("metric", "christoffel"):
        np.testing.assert_allclose(joined(compiled, name), joined(interpreted, name), rtol=1e-13, atol=1e-13)


def test_state_that_fails_is_listed_and_the_item_goes_on(library: MemoryLibrary) -> None:
    request = {"quantities": ["forces"], "q": [[0.0], [1.0]], "parameters": {"arm.m": [1.0, 1e308], "g": 1e308}}
    (outcome,) = outcomes(library, "evaluate", {"items": [{"tree": "cell", "request": request}]})
    assert outcome.summary["failures"] == 1
    missing = {"quantities": ["forces"], "q": [[0.0]]}
    (outcome,) = outcomes(library, "evaluate", {"items": [{"tree": "free", "request": missing}]})
    assert outcome.problem is not None
    assert outcome.problem["code"] == "missing-value"


EVALUATION: dict[str, Any] = {"tree": "cell", "request": {"quantities": ["metric"]}}


@pytest.mark.parametrize(
    ("kind", "request_", "expected"),
    [
        ("dance", {"items": [{}]}, ("/kind", "unknown-kind")),
        ("verify", {}, ("/items", "missing")),
        ("verify", {"items": []}, ("/items", "empty")),
        ("verify", {"items": {}}, ("/items", "empty")),
        ("verify", {"items": [{}], "template": {}}, ("/items", "missing")),
        ("verify", {"items": [{}], "priority": 1}, ("/priority", "unknown-field")),
        ("verify", {"items": [{"substructure": "pendulum"}] * 101}, ("/items", "too-many-items")),
        ("verify", {"items": [{"substructure": "pendulum"}, 5]}, ("/items/1", "object-expected")),
        ("verify", {"items": [{"substructure": "pendulum"}, {}]}, ("/items/1/substructure", "missing")),
        ("verify", {"items": [{"substructure": "pendulum", "x": 1}]}, ("/items/0/x", "unknown-field")),
        ("verify", {"items": [{"substructure": "nothing"}]}, ("/substructure", "unknown-substructure")),
        ("verify", {"items": [{"substructure": {}}]}, ("/substructure", "unknown-substructure")),
        ("assemble", {"items": [{"name": "BAD"}]}, ("/name", "string-pattern-mismatch")),
        (
            "assemble",
            {"items": [FREE | {"instances": [{"name": "a", "substructure": "x"}]}]},
            ("/instances/0/substructure", "unknown-substructure"),
        ),
        (
            "assemble",
            {"items": [FREE | {"instances": [{"name": "a", "substructure": "pendulum", "parameters": {"x": 1}}]}]},
            ("/instances/0/parameters/x", "unknown-parameter"),
        ),
        (
            "assemble",
            {"items": [{**TREE, "instances": [*TREE["instances"], HAND | {"at": "arm.nose"}]}]},
            ("/instances/1/at", "unknown-port"),
        ),
        ("assemble", {"template": TREE}, ("/choices", "missing")),
        ("assemble", {"template": TREE, "choices": {"arm": []}}, ("/choices/arm", "list-expected")),
        ("assemble", {"template": TREE, "choices": {"leg": ["x"]}}, ("/choices/leg", "unknown-choice")),
        (
            "assemble",
            {"template": TREE, "choices": {"/instances/7/at": ["x"]}},
            ("/choices/~1instances~17~1at", "unknown-choice"),
        ),
        ("assemble", {"template": TREE, "choices": {"arm.l": list(range(101))}}, ("/choices", "too-many-items")),
        ("assemble", {"template": [], "choices": {"arm": ["x"]}}, ("/template", "object-expected")),
        ("derive", {"items": [{"name": "x", "bodies": 3}]}, ("/bodies", "tuple-type")),
        ("export", {"items": [{"tree": "cell"}]}, ("/items/0/quantity", "missing")),
        ("export", {"items": [{"tree": "no", "quantity": "metric", "format": "c"}]}, ("/tree", "unknown-tree")),
        (
            "export",
            {"items": [{"tree": "cell", "quantity": "metric", "format": "x"}]},
            ("/items/0/format", "unknown-format"),
        ),
        (
            "export",
            {"items": [{"tree": "cell", "quantity": 5, "format": "c"}]},
            ("/items/0/quantity", "string-expected"),
        ),
        ("evaluate", {"items": [{"tree": "no", "request": {}}]}, ("/items/0/tree", "unknown-tree")),
        ("evaluate", {"items": [{"tree": "cell", "request": []}]}, ("/items/0/request", "object-expected")),
        ("evaluate", {"items": [{"tree": "cell", "request": {}}]}, ("/items/0/request/quantities", "missing")),
        (
            "evaluate",
            {"items": [{"tree": "cell", "request": {"quantities": [{}]}}]},
            ("/items/0/request/quantities/0", "unknown-quantity"),
        ),
        ("evaluate", {"items": [EVALUATION | {"grid": {}}]}, ("/items/0/grid", "object-expected")),
        ("evaluate", {"items": [EVALUATION | {"grid": {"arm.x": [1]}}]}, ("/items/0/grid/arm.x", "unknown-name")),
        (
            "evaluate",
            {"items": [EVALUATION | {"grid": {"arm.q": [1, "x"]}}]},
            ("/items/0/grid/arm.q/1", "number-expected"),
        ),
        ("evaluate", {"items": [EVALUATION | {"grid": {"arm.q": {"from": 0}}}]}, ("/items/0/grid/arm.q", "axis")),
        (
            "evaluate",
            {"items": [EVALUATION | {"grid": {"arm.q": {"from": 0, "to": 1, "count": 0}}}]},
            ("/items/0/grid/arm.q/count", "count"),
        ),
        (
            "evaluate",
            {
                "items": [
                    EVALUATION
                    | {
                        "grid": {
                            "arm.q": {"from": 0, "to": 1, "count": 10000},
                            "arm.m": {"from": 0, "to": 1, "count": 10000},
                        }
                    }
                ]
            },
            ("/items/0/grid", "too-many-states"),
        ),
        ("evaluate", {"items": [EVALUATION | {"sample": {}}]}, ("/items/0/sample/count", "count")),
        ("evaluate", {"items": [EVALUATION | {"sample": {"count": 1, "seed": -1}}]}, ("/items/0/sample/seed", "seed")),
        (
            "evaluate",
            {"items": [EVALUATION | {"sample": {"count": 1, "ranges": {"arm.q": [2, 1]}}}]},
            ("/items/0/sample/ranges/arm.q", "range"),
        ),
        (
            "evaluate",
            {"items": [{**EVALUATION, "tree": "free", "sample": {"count": 1}}]},
            ("/items/0/sample/ranges", "missing"),
        ),
        (
            "evaluate",
            {"items": [EVALUATION | {"sample": {"count": 1}, "grid": {"arm.q": 0}}]},
            ("/items/0/request", "states"),
        ),
        ("evaluate", {"items": [EVALUATION | {"format": []}]}, ("/items/0/format", "unknown-format")),
    ],
)
def test_what_cannot_be_resolved_is_refused_with_a_pointer(
    library: MemoryLibrary, kind: str, request_: dict[str, Any], expected: tuple[str, str]
) -> None:
    assert expected in faults(library, kind, request_, Limits(job_items=100, job_states=100))


def test_every_kind_is_tried_here() -> None:
    assert KINDS[:5] == ("assemble", "evaluate", "export", "derive", "verify")
    assert KINDS[5:] == ("simulate", "optimise", "analyse")  # tests/service/test_jobs_analyse.py


def test_an_error_of_ours_is_the_problem_of_one_item(caplog: pytest.LogCaptureFixture) -> None:
    outcome = run("verify", {"substructure": "pendulum@x", "program": "y"}, {}, quiet)
    assert outcome.problem is not None
    assert (outcome.problem["status"], outcome.problem["code"]) == (500, "internal-error")
    assert "KeyError" in caplog.text
