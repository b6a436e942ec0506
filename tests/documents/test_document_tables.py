"""Curves given as CSV: what is stored are their points; files of a folder; what is refused, with its line."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from substructures import Definition, InvalidDocument, TreeSpec, couple, derive
from substructures.documents import tables
from substructures.documents.tables import with_points, with_tables
from substructures.quantities.numbers.evaluation import evaluate

Plain = dict[str, Any]
BUMP = "x,y\n0,0\n0.1,5\n\n2e-1,-3.50\n"
POINTS = "0: 0, 0.1: 5, 0.2: -3.5"


def slide(force: str, **more: Any) -> Plain:
    joint = {"type": "prismatic", "coordinate": "x"}
    return {
        "name": "slide",
        "description": "table(q1; bump) is a text here",
        "bodies": [{"name": "b", "parent": "base", "mass": 1, "joint": joint}],
        "loads": [{"type": "joint", "coordinate": "x", "force": force}],
        **more,
    }


@pytest.mark.parametrize(
    ("force", "written"),
    [
        ("table(x; bump)", f"table(x; {POINTS})"),
        ("-2*table(x/2 ; bump ; monotone)", f"-2*table(x/2 ; {POINTS} ; monotone)"),
        ("table(table(x; bump); bump; smooth) + 1", f"table(table(x; {POINTS}); {POINTS}; smooth) + 1"),
        ("table(x; 0: 0, 1: 1; smooth)", "table(x; 0: 0, 1: 1; smooth)"),
    ],
)
def test_what_is_stored_are_the_points(force: str, written: str) -> None:
    named = Definition.read(slide(force, tables={"bump": BUMP}))
    plain = Definition.read(slide(written))
    assert named == plain
    assert named.digest == plain.digest
    assert b"tables" not in named.canonical()
    assert named.description == "table(q1; bump) is a text here"


@pytest.mark.parametrize(
    "text", ["0;0\n0.1;5\n0.2;-3.5", "x\ty\r\n0\t0\r\n0.1\t5\r\n0.2\t-3.5", "\ufeffx , y\n0 , 0\n.1,5\n0.2,-3.5"]
)
def test_separators(text: str) -> None:
    assert with_points({"tables": {"bump": text}, "force": "table(x; bump)"}) == {"force": f"table(x; {POINTS})"}


def test_numbers_between_the_points() -> None:
    part = derive(Definition.read(slide("table(x; bump)", tables={"bump": BUMP})))
    model = couple(TreeSpec.read({"name": "t", "instances": [{"name": "s", "substructure": "slide"}]}), {"s": part})
    found = evaluate(model, "forces", q=[[-1.0], [0.05], [0.15], [1.0]])["forces"]
    np.testing.assert_allclose(np.ravel(found), [0, 2.5, 0.75, -3.5], atol=1e-12)


def test_a_tree_has_its_own_and_its_definitions_theirs() -> None:
    inner = slide("table(x; bump)", tables={"bump": "0,0\n1,7"})
    load = {"name": "f", "type": "joint", "coordinate": "s.x", "force": "table(s.x; bump)"}
    tree = {"name": "t", "instances": [{"name": "s", "definition": inner}], "loads": [load], "tables": {"bump": BUMP}}
    spec = TreeSpec.read(tree)
    assert spec.loads[0].model_dump()["force"] == f"table(s.x; {POINTS})"
    definition = spec.instances[0].definition
    assert definition is not None
    assert definition.loads[0].model_dump()["force"] == "table(x; 0: 0, 1: 7)"
    assert "tables" not in spec.canonical().decode()
    inner["tables"] = {"bump": "0,0\n0,1"}
    with pytest.raises(InvalidDocument) as raised:
        TreeSpec.read(tree)
    assert raised.value.faults[0].pointer == "/instances/0/definition/tables/bump"


@pytest.mark.parametrize(
    ("given", "pointer", "code", "message"),
    [
        ("0,0\n0.2,1\n0.1,2", "/tables/bump", "bad-table", r"line 3: 0.1 is not above 0.2"),
        ("x,y\n\n0,0\n1,one", "/tables/bump", "bad-table", r"line 4: 'one' is no number"),
        ("0;0\n0,1;5", "/tables/bump", "bad-table", r"line 2: '0,1' is no number"),
        ("0,0\n1,2,3", "/tables/bump", "bad-table", r"line 2: 3 columns"),
        ("x,y\n0,0", "/tables/bump", "bad-table", r"1 rows; 2 to 10,000"),
        ("", "/tables/bump", "bad-table", r"0 rows"),
        ("0,nan\n1,inf", "/tables/bump", "bad-table", r"line 1: 'nan'"),
        (f"0,0\n1,1e{'9' * 9}", "/tables/bump", "bad-table", r"line 2: .*digits"),
        ({"file": "bump.csv"}, "/tables/bump", "bad-table", r"CSV text"),
        ("\n".join(f"{i},{i}" for i in range(2000)), "/loads/0/force", "too-large", r"fewer points"),
        ("\n".join(f"{i},{i}" for i in range(10_001)), "/tables/bump", "bad-table", r"10,001 rows"),
    ],
)
def test_what_is_refused(given: Any, pointer: str, code: str, message: str) -> None:
    with pytest.raises(InvalidDocument, match=message) as raised:
        Definition.read(slide("table(x; bump)", tables={"bump": given}))
    assert (raised.value.faults[0].pointer, raised.value.faults[0].code) == (pointer, code)


def test_names_that_are_not_there() -> None:
    with pytest.raises(InvalidDocument, match=r"no table 'bmp'; did you mean 'bump'") as raised:
        Definition.read(slide("table(x; bmp; smooth)", tables={"bump": BUMP}))
    assert (raised.value.faults[0].pointer, raised.value.faults[0].code) == ("/loads/0/force", "unknown-table")
    for name in ("monotone", "1st", "a.b"):
        with pytest.raises(InvalidDocument, match="cannot be the name"):
            Definition.read(slide("x", tables={name: BUMP}))
    with pytest.raises(InvalidDocument, match="object of CSV texts"):
        Definition.read(slide("x", tables=[BUMP]))


def test_a_document_cannot_grow_without_end() -> None:
    load = {"type": "joint", "coordinate": "x", "force": "table(x; bump)"}
    reading = tables._Reading({"bump": POINTS}, 100)
    with pytest.raises(InvalidDocument, match="fewer points"):
        reading.replaced([load] * 5, "/loads")


def test_files_of_the_folder(tmp_path: Path) -> None:
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "bump.csv").write_text(BUMP)
    given = slide("table(x; bump)", tables={"bump": {"file": "data/bump.csv"}, "more": "0,0\n1,1"})
    found = with_tables(given, tmp_path)
    assert found["tables"] == {"bump": BUMP, "more": "0,0\n1,1"}
    assert given["tables"]["bump"] == {"file": "data/bump.csv"}
    assert Definition.read(found) == Definition.read(slide(f"table(x; {POINTS})"))
    tree = {"name": "t", "instances": [{"name": "s", "definition": given}, {"name": "r", "substructure": "slide"}]}
    assert with_tables(tree, tmp_path)["instances"][0]["definition"]["tables"]["bump"] == BUMP
    assert with_tables(slide("x"), tmp_path) == slide("x")


def test_files_that_are_refused(tmp_path: Path) -> None:
    folder = tmp_path / "here"
    folder.mkdir()
    (tmp_path / "secret.csv").write_text(BUMP)
    (folder / "link.csv").symlink_to(tmp_path / "secret.csv")
    (folder / "large.csv").write_bytes(b"0" * (tables.MOST_BYTES + 1))
    (folder / "bytes.csv").write_bytes(b"\xff\xfe\x00")
    for name, message in (
        ("../secret.csv", "not in the folder"),
        (str(tmp_path / "secret.csv"), "not in the folder"),
        ("link.csv", "not in the folder"),
        ("none.csv", "cannot be read"),
        (".", "cannot be read"),
        ("large.csv", "more than 1,048,576 bytes"),
        ("bytes.csv", "no text in UTF-8"),
        (5, "is a text"),
    ):
        definition = slide("table(x; bump)", tables={"bump": {"file": name}})
        with pytest.raises(InvalidDocument, match=message) as raised:
            with_tables(definition, folder)
        assert (raised.value.faults[0].pointer, raised.value.faults[0].code) == ("/tables/bump/file", "bad-file")
        with pytest.raises(InvalidDocument) as raised:
            with_tables({"name": "t", "instances": [{"name": "s", "definition": definition}]}, folder)
        assert raised.value.faults[0].pointer == "/instances/0/definition/tables/bump/file"
