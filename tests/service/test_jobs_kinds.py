"""Kinds of jobs: items compute what the library computes."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from service.content.summaries import PartContent, part_content
from service.content.tree_content import TreeContent
from service.content.tree_summaries import summary_text
from service.database.packed import unpack
from service.jobs.kinds import KINDS, expand, run, submission
from service.jobs.kinds import derive as of_derive
from service.settings import Limits
from substructures.documents import read_json, write_json
from substructures.errors import InvalidDocument
from substructures.export import render
from substructures.part.derive import derive
from substructures.tree.couple import couple
from substructures.tree.document import TreeSpec
from substructures.tree.model import Model

from .conftest import HAND, PENDULUM, SLIDER, TREE
from .job_outcomes import faults, known_library, outcomes, quiet
from .jobs_library import MemoryLibrary


@pytest.fixture(scope="module")
def library() -> MemoryLibrary:
    return known_library()


def test_assemble_gives_what_coupling_gives(library: MemoryLibrary) -> None:
    tree = {**TREE, "instances": [*TREE["instances"], HAND]}
    (outcome,) = outcomes(library, "assemble", {"items": [tree]})
    spec = TreeSpec.read(read_json(outcome.files["spec"]))
    model = couple(spec, dict.fromkeys(("arm", "hand"), library.parts["pendulum"]))
    assert outcome.problem is None
    program = unpack(outcome.files["program"])
    assert program == model.program.to_bytes()
    assert outcome.summary["program"] == model.program.digest
    assert outcome.summary["digest"] == spec.digest
    digest = library.parts["pendulum"].definition.digest
    assert {i.substructure for i in spec.instances} == {f"pendulum@{digest}"}
    assert outcome.summary["parts"] == {"arm": digest, "hand": digest}
    content = TreeContent.of_files(outcome.summary, outcome.files)
    text = summary_text(content.summary.values, content.summary.form, outcome.files["spec"].decode())
    stored = Model.load(read_json(text.encode()), program)
    assert stored.coordinates == model.coordinates


def test_assemble_brings_inline_definitions_along(library: MemoryLibrary) -> None:
    inline = {"name": "x", "definition": {**SLIDER, "name": "mine"}, "at": "arm.tip"}
    (outcome,) = outcomes(library, "assemble", {"items": [{**TREE, "instances": [*TREE["instances"], inline]}]})
    part = derive(TreeSpec.read(read_json(outcome.files["spec"])).instances[1].definition or pytest.fail("inline"))
    content = PartContent.of_files(outcome.files, "x.")
    assert content.row["definition"].encode() == part.definition.canonical()
    assert unpack(content.program) == part.program.to_bytes()
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
    asked = {"kind": "assemble", "template": tree, "choices": choices}
    items = expand(submission(asked), Limits(), library)
    names = ["cell-pendulum-1-9-81", "cell-pendulum-1-5-9-81", "cell-limited-1-9-81", "cell-limited-1-5-9-81"]
    assert [item["tree"]["name"] for item in items] == names
    assert [item["tree"]["instances"][0]["parameters"] for item in items] == [{"l": 1}, {"l": "1.5"}] * 2
    assert "parameters" not in tree["instances"][0]
    asked = {"kind": "assemble", "template": {**tree, "name": "c" * 64}, "choices": {"arm.l": [1, 2]}}
    long = expand(submission(asked), Limits(), library)
    assert [item["tree"]["name"] for item in long] == ["c" * 62 + "-1", "c" * 62 + "-2"]


def test_a_choice_of_an_instance_carries_its_own_port_and_numbers(library: MemoryLibrary) -> None:
    tree = {**TREE, "instances": [*TREE["instances"], {**HAND, "parameters": {"m": 2}}]}
    own = {"substructure": "limited", "at": "world", "placement": {"position": [1, 0, 0]}, "parameters": {}}
    asked = {"kind": "assemble", "template": tree, "choices": {"hand": ["pendulum", own], "arm.l": [1, 2]}}
    items = expand(submission(asked), Limits(), library)
    hands = [item["tree"]["instances"][1] for item in items]
    assert [(hand["name"], hand["at"]) for hand in hands] == [("hand", HAND["at"])] * 2 + [("hand", "world")] * 2
    assert [hand["parameters"] for hand in hands[1:3]] == [{"m": 2}, {}]  # in place of those of the template
    names = ["cell-pendulum-1", "cell-pendulum-2", "cell-limited-world-1", "cell-limited-world-2"]
    assert [item["tree"]["name"] for item in items] == names
    wrong = {**asked, "choices": {"hand": ["pendulum", {"substructure": "limited", "att": "world"}]}}
    with pytest.raises(InvalidDocument, match="no 'att'; did you mean 'at'") as caught:
        expand(submission(wrong), Limits(), library)
    assert caught.value.faults[0].pointer == "/choices/hand/1/att"


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
    assert outcome.problem["code"] == "damaged-content"
    assert outcome.problem["digest"] == item["program"]
    wrong = {**item, "program": other.digest}
    outcome = run("verify", wrong, library.blobs, quiet)
    assert outcome.problem is not None


def test_compare_is_one_against_many(library: MemoryLibrary) -> None:
    """References, documents and files; the differing one is told, and a file beside it is read at once."""
    longer = {**PENDULUM, "parameters": {**PENDULUM["parameters"], "l": {"value": 3}}}
    told = outcomes(library, "compare", {"items": [{"a": "pendulum", "b": ["pendulum@1", PENDULUM, longer, "cell"]}]})
    assert [o.summary.get("equal") for o in told] == [True, True, False, True]
    assert [o.summary["b"] for o in told] == ["pendulum", "pendulum", "pendulum", "cell"]
    file = {"file": "# convention: standard\na,alpha,d,theta,name\n0.1,0,0.2,0,q\n"}
    (drawn,) = outcomes(library, "compare", {"items": [{"a": file, "b": file}]})
    assert drawn.summary["level"] == "formulas"
    assert len(library.items("compare", {"items": [{"a": "pendulum", "b": "*"}]})) == len(library.parts)


@pytest.mark.parametrize(
    ("item", "pointer"),
    [
        ({"a": "pendulum"}, "/b"),
        ({"a": "pendulum", "b": ["nothing"]}, "/b"),
        ({"a": "pendulum", "b": []}, "/b"),
        ({"a": "pendulum", "b": ["pendulum", 5]}, "/b/1"),
        ({"a": {"file": "<html/>"}, "b": "pendulum"}, "/a"),
        ({"a": "pendulum", "b": {"name": "x", "bodies": 3}}, "/b/bodies"),
        ({"a": "pendulum", "b": "pendulum", "coordinates": ["q"]}, "/coordinates"),
    ],
)
def test_compare_refuses_what_cannot_be_compared(library: MemoryLibrary, item: Any, pointer: str) -> None:
    with pytest.raises(InvalidDocument) as caught:
        library.items("compare", {"items": [item]})
    assert caught.value.faults[0].pointer.removeprefix("/items/0") == pointer


def test_export_prints_what_the_service_prints(library: MemoryLibrary) -> None:
    item = {"tree": "cell", "quantity": "metric", "format": "latex"}
    numbers = {**item, "format": "text", "form": "expanded", "bind": "defaults"}
    first, second = outcomes(library, "export", {"items": [item, numbers]})
    tree = library.tree("cell")
    assert tree is not None
    model = Model.load(read_json(tree.summary.encode()), library.blobs[tree.program])
    assert first.files["text"].decode() == render(model.program.select(["metric"]), "latex", "readable")
    assert "= 2.2\n" in second.files["text"].decode()  # m l^2 + m l^2 / 10


def test_export_prints_grouped_symbols(library: MemoryLibrary) -> None:
    item = {"tree": "cell", "quantity": "metric", "format": "text", "group": True}
    (found,) = outcomes(library, "export", {"items": [item]})
    assert "stands for" in found.files["text"].decode()
    for wrong, pointer in (({"quantity": "potential_energy"}, "/group"), ({"group": "yes"}, "/group")):
        with pytest.raises(InvalidDocument) as caught:
            library.items("export", {"items": [{**item, **wrong}]})
        assert caught.value.faults[0].pointer.endswith(pointer)


def test_export_makes_the_files_of_targets(library: MemoryLibrary) -> None:
    item = {"tree": "cell", "target": "maxima", "quantities": ["metric"]}
    first, second = outcomes(library, "export", {"items": [item, {**item, "target": "c", "name": "arm"}]})
    assert "cell_metric(q, p) := block(" in first.files["text"].decode()
    assert second.files["archive"].startswith(b"PK")
    assert second.summary["media_type"] == "application/zip"
    (robot,) = outcomes(library, "export", {"items": [{"tree": "cell", "target": "urdf", "name": "clock"}]})
    assert b'<robot name="clock">' in robot.files["text"]


@pytest.mark.parametrize(
    ("given", "pointer"),
    [
        ({"target": "exe"}, "/target"),
        ({"quantities": ["metric", 1]}, "/quantities/1"),
        ({"target": "urdf", "quantities": ["metric"]}, "/quantities"),
        ({"together": 1}, "/together"),
        ({"packed": "yes"}, "/packed"),
        ({"target": "urdf", "packed": True}, "/packed"),
        ({"bind": 1}, "/bind"),
        ({"name": []}, "/name"),
    ],
)
def test_export_refuses_bad_targets(library: MemoryLibrary, given: Any, pointer: str) -> None:
    with pytest.raises(InvalidDocument) as caught:
        library.items("export", {"items": [{"tree": "cell", "target": "c", **given}]})
    assert caught.value.faults[0].pointer.endswith(pointer)


@pytest.mark.parametrize(
    ("given", "pointer"),
    [
        ({"options": {"outputs": ["sin(nose)"]}}, "/options/outputs/0"),
        ({"options": {"cyclic": ["arm.q"]}}, "/options/cyclic"),
        ({"bind": "arm.m:nose"}, "/bind"),
    ],
)
def test_faults_of_formulas_point_into_the_item(library: MemoryLibrary, given: dict[str, object], pointer: str) -> None:
    item = {"tree": "cell", "quantity": "state_space", "format": "text", **given}
    (outcome,) = outcomes(library, "export", {"items": [item]})
    assert outcome.problem is not None
    assert [fault["pointer"] for fault in outcome.problem["errors"]] == [pointer]
    assert "/query" not in outcome.problem["detail"]


@pytest.mark.parametrize("item", [{"substructure": "*"}, {"tree": "*"}])
def test_upgrade_keeps_what_is_as_short(library: MemoryLibrary, item: dict[str, str]) -> None:
    for outcome in outcomes(library, "upgrade", {"items": [item]}):
        assert outcome.summary["outcome"] == "as it was"
        assert outcome.summary["before"] == outcome.summary["after"]
        assert not outcome.files


def test_every_kind_is_tried_here() -> None:
    assert KINDS[:5] == ("assemble", "evaluate", "export", "derive", "verify")
    assert KINDS[5:7] == ("upgrade", "compare")
    assert KINDS[7:10] == ("simulate", "optimise", "analyse")  # tests/service/test_jobs_analyse.py
    assert KINDS[10:] == ("mirror", "sweep")  # tests/service/test_jobs_mirror.py, test_sweeps.py


def test_an_error_of_ours_is_the_problem_of_one_item(caplog: pytest.LogCaptureFixture) -> None:
    outcome = run("verify", {}, {}, quiet)
    assert outcome.problem is not None
    assert (outcome.problem["status"], outcome.problem["code"]) == (500, "internal-error")
    assert "KeyError" in caplog.text


def test_units_are_checked_before_anything_is_queued(library: MemoryLibrary) -> None:
    """A definition and a tree in other units are taken; contradictions are refused with their places."""
    lengths = {"l": {"value": 1200, "unit": "mm"}, "m": {"unit": "kg"}}
    given = {**PENDULUM, "name": "mm", "parameters": lengths}
    (made,) = outcomes(library, "derive", {"items": [given]})
    assert made.summary["name"] == "mm"
    wrong = {**given, "bodies": [{**PENDULUM["bodies"][0], "mass": {"value": 3, "unit": "furlong"}}]}
    assert faults(library, "derive", {"items": [wrong]}) == {("/bodies/0/mass", "unit-mismatch")}
    bound = {**TREE["instances"][0], "parameters": {"l": {"value": 2, "unit": "cm"}}}
    tree = {**TREE, "name": "mm", "instances": [bound]}
    (made,) = outcomes(library, "assemble", {"items": [tree]})
    assert made.summary["warnings"] == []
    tree["gravity"] = [0, {"value": 1, "unit": "N"}, 0]
    assert faults(library, "assemble", {"items": [tree]}) == {("/gravity/1", "unit-mismatch")}


@pytest.mark.parametrize("error", [MemoryError, SystemError])
def test_what_the_process_does_not_outlive_is_no_problem_of_the_item(
    error: type[Exception], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whoever watches the process tells why it ended: an allocation in a library may fail as a SystemError."""

    def broken(*_: Any) -> Any:
        raise error("error return without exception set")

    monkeypatch.setitem(of_derive.KINDS, "derive", replace(of_derive.KINDS["derive"], run=broken))
    with pytest.raises(error):
        run("derive", {}, {}, lambda _: None)
