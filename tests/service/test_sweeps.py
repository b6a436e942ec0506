"""Sweeps over HTTP: accepted at once, computed in ranges of rows, read as tables, front and trees."""

from __future__ import annotations

import io
from statistics import stdev
from typing import Any, cast

import numpy as np
import pytest
from fastapi.testclient import TestClient

from service.content.cache import Cache
from service.jobs.kinds import sweep as kind
from service.operations.jobs import tables
from service.operations.jobs.tables import Table
from service.store.store import Store
from service.views import tables as views
from substructures.formats import arrow
from substructures.formats.arrays import read_npz
from substructures.sweeps import block

from .conftest import PENDULUM, SLIDER
from .fake_engine import FakeEngine, finished, running, submitted
from .jobs_library import MemoryLibrary
from .reading import read

SWEEP: dict[str, Any] = {
    "kind": "sweep",
    "labels": {"study": "night", "arm": "long"},
    "template": {
        "name": "pair",
        "gravity": [0, "-9.81", 0],
        "instances": [
            {"name": "arm", "substructure": "pendulum"},
            {"name": "hand", "substructure": "pendulum", "at": "arm.tip"},
        ],
    },
    "choices": {
        "hand": [
            "pendulum",
            {"substructure": "pendulum", "parameters": {"m": 5}},
            {"substructure": "slider", "at": "arm.tip"},
            {"substructure": "pendulum", "at": "arm.nowhere"},
        ]
    },
    "samples": {"of": {"arm.m": {"uniform": [1, 3], "count": 5}, "arm.l": {"values": [500, 1000], "unit": "mm"}}},
    "columns": {
        "mass": "mass",
        "torque": {"quantity": "gravity", "of": "arm.q", "over": {"q": [0.3, 0.1]}, "take": "largest_absolute"},
        "use": "torque/mass",
    },
    "where": "torque < 90",
    "pareto": {"minimise": ["torque"], "maximise": ["mass"]},
    "proof": 40,
}


def done(client: TestClient, store: Store, document: dict[str, Any]) -> str:
    with running(store, FakeEngine()):
        job = submitted(client, document)
        assert finished(client, job)["state"] == "succeeded"
    return job


def table(client: TestClient, job: str, query: str = "", what: str = "table") -> dict[str, Any]:
    found = client.get(f"/v1/jobs/{job}/{what}{query}")
    assert found.status_code == 200, found.text
    told: dict[str, Any] = found.json()
    return told


def test_a_sweep_is_a_table(filled: TestClient, store: Store) -> None:
    job = done(filled, store, SWEEP)
    whole = table(filled, job, "?page_size=100")
    assert whole["columns"] == ["row", "hand", "arm.m", "arm.l", "mass", "torque", "use"]
    assert (whole["rows"], whole["done"], whole["state"]) == (40, 40, "succeeded")
    # the slider needs a stiffness, but not for gravity; no body or port is called nowhere
    assert {code: each["rows"] for code, each in whole["refused"].items()} == {"unknown-port": 10}
    assert whole["finite"] == 30
    assert whole["count"] == whole["kept"] == whole["proven"] == len(whole["items"]) <= 30
    assert all(row["torque"] < 90 and row["use"] == row["torque"] / row["mass"] for row in whole["items"])
    assert {row["hand"] for row in whole["items"]} >= {"pendulum #1", "slider"}

    page = table(filled, job, "?sort=-torque&page_size=4&columns=torque,mass&where=mass>3")
    assert page["columns"] == ["row", "torque", "mass"]
    torques = sorted((row["torque"] for row in whole["items"] if row["mass"] > 3), reverse=True)
    assert [row["torque"] for row in page["items"]] == torques[:4]
    following = filled.get(page["links"]["next"]).json()
    assert [row["torque"] for row in following["items"]] == torques[4:8]

    front = table(filled, job, what="pareto")["items"]
    for row in whole["items"]:
        beaten = any(
            one["torque"] <= row["torque"] and one["mass"] >= row["mass"] and one["row"] != row["row"] for one in front
        )
        assert beaten != (row["row"] in [one["row"] for one in front])

    column = table(filled, job, "/columns/torque?bins=3")
    assert column["count"] == sum(column["histogram"]["counts"]) == whole["count"]
    torques = [row["torque"] for row in whole["items"]]
    assert column["quantiles"]["1"] == max(torques)
    assert column["deviation"] == pytest.approx(stdev(torques))
    alone = table(filled, job, f"/columns/torque?where=torque>={max(torques)}")
    assert (alone["count"], alone["mean"], alone["deviation"]) == (1, max(torques), None)

    for label in ("study:night", "arm:long", "study:night arm:long"):
        assert [each["id"] for each in filled.get("/v1/jobs", params={"label": label}).json()["items"]] == [job]
    assert filled.get("/v1/jobs?label=study").json()["items"] == []


def test_rows_become_text_some_at_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(views, "AT_A_TIME", 2)
    for count in range(6):
        columns = {"row": np.arange(count), "x": np.arange(count) / 2}
        pieces = list(views.as_csv(Table(cast("Any", None), columns, {})))
        assert len(pieces) == max(1, (count + 1) // 2)
        text = "".join(f"{k},{k / 2}\r\n" for k in range(count))
        assert b"".join(pieces).decode() == f"row,x\r\n{text}"


@pytest.mark.parametrize("count", [0, 1, 2, 7])
def test_tables_become_files_some_rows_at_a_time(monkeypatch: pytest.MonkeyPatch, count: int) -> None:
    """Record batches and row groups of so many rows, columns of an npz one by one."""
    pyarrow, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    monkeypatch.setattr(views, "OF_A_GROUP", 2)
    columns = {"row": np.arange(count), "part": np.arange(count).astype(str), "x": np.arange(count) / 2}
    whole = Table(cast("Any", None), columns, {})
    files = {media: list(views.as_file(whole, media)) for media in (views.NPZ, views.PARQUET, arrow.MEDIA_TYPE)}
    packed = {media: b"".join(pieces) for media, pieces in files.items()}
    batches = list(pyarrow.ipc.open_stream(packed[arrow.MEDIA_TYPE]))
    groups = parquet.ParquetFile(io.BytesIO(packed[views.PARQUET]))
    assert len(batches) == groups.num_row_groups == len(files[arrow.MEDIA_TYPE]) - 1 == (count + 1) // 2
    npz = read_npz(io.BytesIO(packed[views.NPZ]), len(packed[views.NPZ]))
    for name, values in columns.items():
        assert npz[name].tolist() == groups.read().column(name).to_pylist() == values.tolist()
        assert [x for batch in batches for x in batch.column(name).to_pylist()] == values.tolist()


@pytest.mark.parametrize("bins", [1, 20, 1000])
@pytest.mark.parametrize("values", [[1, 1 + 2**-52], [1e17, 1e17], [0, 5e-324], [3, 3], [-1, 2], [-1.7e308, 1.7e308]])
def test_histograms_of_what_differs_by_rounding(values: list[float], bins: int) -> None:
    """There is none of what is further apart than the largest number."""
    found = tables.distribution(Table(cast("Any", None), {"x": np.array(values, float)}, {}), "x", bins)["histogram"]
    told = None if found is None else (sum(found["counts"]), len(set(found["edges"])))
    assert told == (None if values[1] > 1e300 else (2, bins + 1))


def test_what_rows_do_is_columns_too(filled: TestClient, store: Store) -> None:
    """Equilibria, reach and motions, with what is not finite told."""
    hanging = {"q": [-1.5, 0]}
    motion = {"analysis": "simulation", "at": {"q": [0, 0]}, "span": [0, 0.5]}
    columns = {
        "hangs": {"analysis": "equilibrium", "at": hanging, "of": "arm.q"},
        "slow": {"analysis": "linearisation", "at": hanging, "settle": True},
        "reach": {"analysis": "reach", "of": "hand.tip"},
        "falls": {**motion, "expression": "arm.q"},
        "effort": {**motion, "expression": "arm.q'^2", "take": "integral"},
        "ratio": "effort/reach",
    }
    more = {"choices": {}, "where": "", "pareto": None, "columns": columns, "proof": 10}
    whole = table(filled, done(filled, store, {**SWEEP, **more}), "?page_size=100")
    assert (whole["count"], whole["proven"], whole["refused"]) == (10, 10, {})
    for row in whole["items"]:
        assert row["hangs"] == pytest.approx(-np.pi / 2)
        assert row["reach"] == pytest.approx(row["arm.l"] + 1)
        assert row["falls"] < 0 < row["effort"]
        assert row["ratio"] == row["effort"] / row["reach"]


def test_columns_keep_their_order(filled: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where they are computed, too: a column names those before it."""
    of = {"arm.m": {"values": [1, 2]}, "arm.l": {"values": [3, 4]}}
    columns = {"weight": "mass", "heavy": "2*weight", "a": "heavy + 1"}
    more = {"choices": {}, "where": "", "pareto": None, "columns": columns, "samples": {"of": of}}
    job = submitted(filled, {**SWEEP, **more})
    monkeypatch.setattr(kind, "_plans", Cache[Any](4, lambda _: 1))  # as of a process that computes
    with running(store, FakeEngine()):
        assert finished(filled, job)["state"] == "succeeded"
    whole = table(filled, job)
    assert whole["columns"] == ["row", "arm.m", "arm.l", "weight", "heavy", "a"]
    assert [(row["arm.m"], row["arm.l"]) for row in whole["items"]] == [(1, 3), (1, 4), (2, 3), (2, 4)]


def test_tables_are_files_and_rows_become_trees(filled: TestClient, store: Store) -> None:
    job = done(filled, store, SWEEP)
    whole = table(filled, job, "?page_size=100")["items"]
    accept = {"npz": "application/x-npz", "arrow": "application/vnd.apache.arrow.stream"}
    npz = filled.get(f"/v1/jobs/{job}/table", headers={"Accept": accept["npz"]}).content
    arrays = read_npz(io.BytesIO(npz), len(npz))
    assert arrays["torque"].tolist() == [row["torque"] for row in whole]
    assert arrays["hand"].tolist() == [row["hand"] for row in whole]
    text = filled.get(f"/v1/jobs/{job}/table?sort=mass", headers={"Accept": "text/csv"}).text.splitlines()
    assert text[0] == "row,hand,arm.m,arm.l,mass,torque,use"
    assert len(text) == len(whole) + 1
    pyarrow, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    stream = filled.get(f"/v1/jobs/{job}/table", headers={"Accept": accept["arrow"]}).content
    assert pyarrow.ipc.open_stream(stream).read_all().column("torque").to_pylist() == [row["torque"] for row in whole]
    kept = filled.get(f"/v1/jobs/{job}/pareto", headers={"Accept": "application/vnd.apache.parquet"}).content
    assert 0 < parquet.read_table(io.BytesIO(kept)).num_rows < len(whole)
    assert filled.get(f"/v1/jobs/{job}/table", headers={"Accept": "image/png"}).status_code == 406

    row = whole[7]
    made = filled.post(f"/v1/jobs/{job}/rows/{row['row']}/tree", json={"name": "chosen"})
    assert made.status_code == 201, made.text
    state = {"quantities": ["gravity"], "q": [0.3, 0.1]}
    numbers = filled.post("/v1/trees/chosen/evaluations", json=state).json()["gravity"]
    assert abs(numbers[0]) == pytest.approx(row["torque"], rel=1e-12)
    assert filled.get("/v1/trees/chosen").json()["mass"] == pytest.approx(row["mass"])
    gone = filled.post(f"/v1/jobs/{job}/rows/4000/tree")
    assert (gone.status_code, gone.json()["code"]) == (404, "unknown-row")
    other = submitted(filled, {"kind": "verify", "items": [{"tree": "cell"}]})
    assert filled.get(f"/v1/jobs/{other}/table").json()["code"] == "no-table"


def test_queries_choose_parts(filled: TestClient, store: Store) -> None:
    choices = {"hand": {"query": {"tag": "planar"}}}
    job = done(filled, store, {**SWEEP, "choices": choices, "keep": 3, "proof": 0})
    whole = table(filled, job)
    assert whole["rows"] == 20
    assert len(whole["items"]) == whole["kept"] == 3


ALONE: dict[str, Any] = {"where": "", "pareto": None}
CHANGES: tuple[tuple[dict[str, Any], str, str], ...] = (
    ({"choices": {"leg": ["pendulum"]}}, "/choices/leg", "unknown-choice"),
    ({"choices": {"hand": ["pendulum", "pendolum"]}}, "/choices/hand/1", "unknown-substructure"),
    ({"choices": {"hand": {"query": {"tag": "nothing"}}}}, "/choices/hand/query", "nothing-found"),
    ({"choices": {"hand": []}}, "/choices/hand", "empty"),
    ({"columns": {"x": {"quantity": "metrik"}}}, "/columns/x/quantity", "unknown-quantity"),
    (
        {"columns": {"x": {"quantity": "gravity", "of": "arm.qq"}}, "where": "", "pareto": None},
        "/columns/x/of",
        "unknown-coordinate",
    ),
    ({"columns": {"x": "mass/weight"}}, "/columns/x", "unknown-column"),
    ({"columns": {"row": "mass"}, **ALONE}, "/columns/row", "duplicate-name"),
    ({"columns": {"hand": "mass"}, **ALONE}, "/columns/hand", "duplicate-name"),
    ({"columns": {"x": {"analysis": "orbit"}}}, "/columns/x", "unknown-column"),
    ({"columns": {"x": {"analysis": "reach", "of": "hand.tap"}}, **ALONE}, "/columns/x/of", "unknown-name"),
    ({"columns": {"x": {"analysis": "equilibrium", "of": "hand.y"}}, **ALONE}, "/columns/x/of", "unknown-coordinate"),
    ({"columns": {"x": {"analysis": "simulation", "span": [0, 1]}}}, "/columns/x", "one-source"),
    ({"columns": {"mass": "mass"}, "where": "mass", "pareto": None}, "/where", "comparison-expected"),
    ({"where": "weight < 3"}, "/where", "unknown-column"),
    ({"pareto": {"minimise": ["weight"]}}, "/pareto/minimise/0", "unknown-column"),
    ({"samples": {"method": "sobol", "of": {"arm.m": {"uniform": [1, 2]}}}}, "/samples", "missing-count"),
    ({"samples": {"of": {"arm.mm": {"values": [1]}}}}, "/samples/of/arm.mm", "unknown-parameter"),
    ({"samples": {"of": {"arm.m": {"values": [1], "unit": "s"}}}}, "/samples/of/arm.m/unit", "unit-mismatch"),
    ({"samples": {"of": {"arm.m": {"uniform": [1, 2], "count": 10**8}}}}, "/samples", "too-many-rows"),
    ({"samples": {"of": {"arm.m": {"uniform": [1, 2], "count": 10**7}}}}, "/keep", "missing"),
    ({"template": {"name": "pair"}}, "/template/instances", "missing"),
    ({"columns": {}}, "/columns", "too_short"),
    ({"columns": {"x": {"quantity": "gravity", "unit": "kg"}}}, "/columns/x/unit", "extra-forbidden"),
    ({"columns": {"x": {"analysis": "reach", "unit": "kg"}}}, "/columns/x/unit", "extra-forbidden"),
    ({"on_invalid": "refuse"}, "/on_invalid", "extra-forbidden"),
    ({"labels": {"a": "b c"}}, "/labels", "bad-label"),
)


def test_flanges_that_do_not_fit_are_told_and_left_out(filled: TestClient, store: Store) -> None:
    """A tree is warned of them, a sweep counts them by reason."""
    flange = {**PENDULUM["ports"][0], "interface": "ISO 9409-1-50-4-M6"}
    for name, more in (
        ("wide", {"ports": [flange]}),
        ("fits", {"mount": {"interface": "ISO 9409-1-50-4-M6"}}),
        ("differs", {"mount": {"interface": "ISO 9409-1-31.5-4-M5"}}),
    ):
        assert filled.post("/v1/substructures", json={**PENDULUM, "name": name, **more}).status_code == 201
    arm = {"name": "arm", "substructure": "wide"}
    warned = []
    for name in ("pendulum", "fits", "differs"):
        hand = {"name": "hand", "substructure": name, "at": f"arm.{flange['name']}"}
        tree = {"name": f"with-{name}", "gravity": [0, 0, 0], "instances": [arm, hand]}
        made = filled.post("/v1/trees", json=tree)
        assert made.status_code == 201
        codes = [each["code"] for each in made.json()["certificate"]["warnings"]]
        warned.append("interfaces-differ" in codes)
    assert warned == [False, False, True]
    template = {**SWEEP["template"], "instances": [arm, {"name": "hand", "substructure": "fits", "at": "arm.tip"}]}
    choices = {"hand": ["pendulum", "fits", "differs"]}
    whole = table(filled, done(filled, store, {**SWEEP, "template": template, "choices": choices, "where": ""}))
    assert {code: each["rows"] for code, each in whole["refused"].items()} == {"interfaces-differ": 10}
    assert whole["kept"] == 20


@pytest.mark.parametrize(("change", "pointer", "code"), CHANGES)
def test_bad_sweeps_are_refused_by_name(filled: TestClient, change: dict[str, Any], pointer: str, code: str) -> None:
    found = filled.post("/v1/jobs", json={**SWEEP, **change})
    assert found.status_code == 422, found.text
    told = [(each["pointer"], each["code"]) for each in found.json()["errors"]]
    assert pointer in [place for place, _ in told]
    assert code in [each for _, each in told] or code.replace("_", "-") in [each for _, each in told], told
    assert filled.get("/v1/jobs").json()["items"] == []


def test_items_are_ranges_that_do_not_matter(monkeypatch: pytest.MonkeyPatch) -> None:
    library = MemoryLibrary([PENDULUM, SLIDER])
    request = {name: x for name, x in SWEEP.items() if name not in ("kind", "labels")} | {"proof": 0}
    whole = [kind.KINDS["sweep"].run(item, library.blobs, lambda _: None) for item in library.items("sweep", request)]
    assert len(whole) == 1
    monkeypatch.setattr(kind, "AT_ONCE", 7)
    parts = [kind.KINDS["sweep"].run(item, library.blobs, lambda _: None) for item in library.items("sweep", request)]
    assert len(parts) == 6
    read = [[kind.rows_of(each.files["rows"]) for each in some] for some in (whole, parts)]
    for name in ("row", "torque", "arm.m"):
        assert np.array_equal(read[0][0][name], np.concatenate([each[name] for each in read[1]]))


def test_ranges_of_motions_are_short(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where every row is a motion, no more of them stand in an item than some seconds of work."""
    library = MemoryLibrary([PENDULUM])
    motion = {"analysis": "simulation", "at": {"q": [1]}, "span": [0, 0.5], "expression": "arm.q"}
    template = {"name": "one", "gravity": [0, "-9.81", 0], "instances": [{"name": "arm", "substructure": "pendulum"}]}

    def items(count: int) -> list[Any]:
        samples = {"method": "sobol", "count": count, "of": {"arm.l": {"uniform": [1, 2]}}}
        return library.items("sweep", {"template": template, "samples": samples, "columns": {"end": motion}})

    found = [each["rows"] for each in items(20_000)]
    assert max(stop - start for start, stop in found) <= 128
    assert [start for start, _ in found] == [0, *(stop for _, stop in found[:-1])]
    assert 500 < len(items(5_000_000)) <= 2000
    whole = kind.KINDS["sweep"].run(items(12)[0], library.blobs, lambda _: None)
    monkeypatch.setattr(kind, "MOTIONS", 5)
    parts = [kind.KINDS["sweep"].run(item, library.blobs, lambda _: None) for item in items(12)]
    assert len(parts) == 3
    ends = [np.concatenate([kind.rows_of(each.files["rows"])["end"] for each in some]) for some in ([whole], parts)]
    assert np.array_equal(*ends)


def test_a_planted_fault_in_one_range_fails_it(monkeypatch: pytest.MonkeyPatch) -> None:
    library = MemoryLibrary([PENDULUM, SLIDER])
    request = {name: x for name, x in SWEEP.items() if name not in ("kind", "labels")} | {"proof": 400}
    item = library.items("sweep", request)[0]
    assert kind.KINDS["sweep"].run(item, library.blobs, lambda _: None).problem is None
    real = block.values_of
    monkeypatch.setattr(block, "values_of", lambda some: {n: x * (1 + 1e-9) for n, x in real(some).items()})
    outcome = kind.KINDS["sweep"].run(item, library.blobs, lambda _: None)
    assert outcome.problem is not None
    assert outcome.problem["code"] == "proof-failed"


def test_plots_show_what_varies(filled: TestClient, store: Store) -> None:
    more = {"choices": {}, "where": "", "pareto": None, "columns": {"a": "mass", "b": "2*a", "same": "dof"}}
    job = done(filled, store, {**SWEEP, **more})
    text = filled.get(f"/jobs/{job}").text
    assert 'placeholder="b"' in text
    assert 'placeholder="a"' in text


def test_the_page_of_a_sweep_is_its_table(filled: TestClient, store: Store) -> None:
    job = done(filled, store, SWEEP)
    page = read(filled, f"/jobs/{job}?sort=-torque&where=mass>3")
    torques = [row["torque"] for row in table(filled, job, "?sort=-torque&where=mass>3&page_size=100")["items"]]
    cells = [f"{x:.6g}" for x in torques]
    assert [word for word in page.words if word in cells][: len(cells)] == cells
    assert f"{len(torques)} of" in page.text
    assert "unknown-port" in page.text
    assert ("class", "plot") in page.attributes
    assert ("data-address", f"/v1/jobs/{job}") in page.attributes
    assert any(name == "data-address" and str(x).endswith("/tree") for name, x in page.attributes)
    assert "truth value" in read(filled, f"/jobs/{job}?where=mass").text
    assert job[:16] in read(filled, "/jobs?label=study:night").text
    assert "None of these" in read(filled, "/jobs?kind=evaluate").text
