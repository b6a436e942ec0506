"""Reduced systems over HTTP: stored, shown, printed, evaluated, moved, scanned over the momentum, exported."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np
import pytest
from fastapi.testclient import TestClient

from service.jobs.kinds import sweep
from service.messages.negotiation import MEDIA_TYPES
from substructures.documents import read_json

from .job_outcomes import joined, outcomes
from .jobs_library import MemoryLibrary

#: a bead on a rod of a table that turns freely, on a spring
TREE: dict[str, Any] = {
    "name": "governor",
    "gravity": [0, 0, -9.81],
    "parameters": {"h": {"value": 2, "unit": "kg*m^2/s"}},
    "instances": [
        {
            "name": "g",
            "definition": {
                "name": "table",
                "parameters": {"k": {"value": 50, "unit": "N/m"}, "J": {"value": 0.2, "unit": "kg*m^2"}},
                "bodies": [
                    {"name": "disc", "parent": "base", "inertia": {"zz": "J"},
                     "joint": {"type": "revolute", "coordinate": "turn"}},
                    {"name": "bead", "parent": "disc", "mass": 1,
                     "joint": {"type": "prismatic", "coordinate": "r", "axis": [1, 0, 0], "stiffness": "k", "rest": 0.3,
                               "placement": {"position": [0, 0, 0]}}},
                ],
            },
        }
    ],
    "ignored": {"g.turn": "h"},
}  # fmt: skip


@pytest.fixture
def governor(client: TestClient) -> TestClient:
    made = client.post("/v1/trees", json=TREE)
    assert made.status_code == 201, made.text
    assert (made.json()["ignored"], made.json()["coordinates"]) == (["g.turn"], ["g.r"])
    return client


def test_it_is_shown_and_printed(governor: TestClient) -> None:
    page = governor.get("/trees/governor").text
    assert "<h2>Given momenta</h2>" in page
    assert "<td>g.turn</td><td>h</td>" in page
    for name in ("metric", "bias", "g_00", "Gamma_a00", "T_0", "ignored_rates", "first_integrals", "lagrangian"):
        for kind in MEDIA_TYPES:
            answer = governor.get(f"/v1/trees/governor/{name}?format={kind}")
            assert answer.status_code == 200, (name, kind, answer.text[:300])
    # -p g_cc^-1 p / 2
    assert "T_0 = -h^2/(2*(J + r^2))" in governor.get("/v1/trees/governor/T_0?format=text").text
    for path in ("report?format=text", "scene", "picture", "program.json", "origins"):
        answer = governor.get(f"/v1/trees/governor/{path}")
        assert answer.status_code == 200, (path, answer.text[:300])
    for path in ("edit", "motion"):
        assert governor.get(f"/trees/governor/{path}").status_code == 200


def test_it_moves_and_rests(governor: TestClient) -> None:
    asked = {"quantities": ["ignored_rates", "g_00", "forward_dynamics"], "q": [0.4]}
    found = governor.post("/v1/trees/governor/evaluations", json=asked).json()
    assert found["ignored"] == ["g.turn"]
    np.testing.assert_allclose(found["ignored_rates"], [2 / 0.36], rtol=1e-12)
    moved = governor.post("/v1/trees/governor/simulations", json={"q": [0.5], "span": [0, 1], "count": 5}).json()
    assert moved["is_right"] is True
    assert moved["checks"][0]["name"] == "energy"
    rests = governor.post("/v1/trees/governor/equilibria", json={"starts": [[0.6]], "count": 1}).json()
    (r,) = (x["q"][0] for x in rests["found"] if x["q"][0] > 0)
    assert 50 * (r - 0.3) == pytest.approx(4 * r / (0.2 + r**2) ** 2, rel=1e-9)
    # over the momentum
    scan = {"parameter": "h", "values": [0, 1, 2], "q": [0.3]}
    loci = governor.post("/v1/trees/governor/root-loci", json=scan)
    assert loci.status_code == 200, loci.text
    body = {"rates": {}, "vary": "h", "between": [0.5, 2], "steps": 5, "starts": [[0.4]], "count": 1}
    families = governor.post("/v1/trees/governor/steady-motions", json=body).json()
    assert {x["value"] for x in families["found"]} >= {0.5, 2}
    wrong = governor.post("/v1/trees/governor/simulations", json={"q": {"g.r": 1, "g.turn": 0}, "span": [0, 1]}).json()
    told = "the momentum of 'g.turn' is given ('ignored'): leave it out"
    assert (wrong["errors"][0]["pointer"], wrong["errors"][0]["message"]) == ("/q/g.turn", told)


@pytest.mark.parametrize(
    ("path", "body"),
    [
        ("publish", {}),
        ("curvatures", {"q": [0.1]}),
        ("evaluations", {"quantities": ["regressor"], "q": [0.1], "qdd": [0]}),
        ("simulations", {"q": [0.1], "span": [0, 1], "contacts": [{"name": "c", "point": "g.bead"}]}),
    ],
)
def test_what_refuses_it_says_why(governor: TestClient, path: str, body: dict[str, Any]) -> None:
    answer = governor.post(f"/v1/trees/governor/{path}", json=body)
    assert answer.status_code == 422, answer.text
    fault = answer.json()["errors"][0]
    assert fault["code"] == "has-ignored", fault
    assert "'g.turn'" in fault["message"]


def test_its_joints_transmit_what_those_of_the_whole_do(governor: TestClient) -> None:
    """The bar pushes the bead sideways, for which its acceleration is needed; its spring and weight are borne, too."""
    asked = {"q": [0.4], "qd": [0.5], "span": [0, 1], "count": 3, "reactions": True, "powers": True}
    found = governor.post("/v1/trees/governor/simulations", json=asked)
    assert found.status_code == 200, found.text
    body = found.json()
    assert body["is_right"] is True
    assert "power" in [check["name"] for check in body["checks"]]
    m, r, v, inertia, h = 1, 0.4, 0.5, 0.2, 2
    whole = inertia + m * r * r
    rate = h / whole
    # h = (J + m r^2) w: w' = -2 m r r' w/(J + m r^2); the bar pushes the bead with m (r w' + 2 r' w)
    push = m * (-2 * m * r * r * v * rate / whole + 2 * v * rate)
    (k,) = (k for k, name in enumerate(body["joints"]) if name == "g.r")
    force = np.array(body["series"]["reaction_force"])[0, k]
    assert np.sort(np.abs(force)) == pytest.approx([push, 50 * 0.1, 9.81], rel=1e-9)
    told = governor.post("/v1/trees/governor/evaluations", json={"quantities": ["reactions"], "q": [0.4], "qd": [0.5]})
    assert told.status_code == 200, told.text


def test_a_force_on_it_is_a_fault(client: TestClient) -> None:
    load = {"type": "joint", "name": "brake", "coordinate": "g.turn", "force": "-g.turn'"}
    answer = client.post("/v1/trees", json={**TREE, "loads": [load]})
    assert answer.status_code == 422
    fault = answer.json()["errors"][0]
    assert (fault["pointer"], fault["code"]) == ("/ignored/g.turn", "not-cyclic")


def test_it_is_an_fmu(governor: TestClient, tmp_path: Path) -> None:
    fmpy = pytest.importorskip("fmpy", reason="the wheel FMPy is not installed")
    answer = governor.get("/v1/trees/governor/export?target=fmu&quantities=forward_dynamics,ignored_rates")
    assert answer.status_code == 200, answer.text
    path = tmp_path / "model.fmu"
    archive = ZipFile(BytesIO(answer.content))
    inside = [name for name in archive.namelist() if name.endswith(".fmu")]
    path.write_bytes(archive.read(inside[0]) if inside else answer.content)
    found = fmpy.simulate_fmu(
        str(path), fmi_type="ModelExchange", stop_time=1, output_interval=0.25, relative_tolerance=1e-10,
        start_values={"g.r": 0.5}, output=["g.r"],
    )  # fmt: skip
    ours = governor.post(
        "/v1/trees/governor/simulations", json={"q": [0.5], "span": [0, 1], "times": found["time"].tolist()}
    ).json()
    np.testing.assert_allclose(found["g.r"], np.array(ours["q"])[:, 0], atol=1e-6)


def test_jobs_take_it() -> None:
    """Assembled, evaluated, simulated, verified, exported and swept as other trees are."""
    (instance,) = TREE["instances"]
    stored = {**TREE, "instances": [{"name": "g", "substructure": "table"}]}
    library = MemoryLibrary([instance["definition"]], [stored])
    (assembled,) = outcomes(library, "assemble", {"items": [stored]})
    assert read_json(assembled.files["form"])["ignored"] == ["g.turn"]
    asked = {"quantities": ["metric", "ignored_rates"], "q": [[0.1], [0.4]]}
    made = outcomes(library, "evaluate", {"items": [{"tree": "governor", "request": asked}]})
    np.testing.assert_allclose(joined(made, "ignored_rates"), [[2 / 0.21], [2 / 0.36]])
    simulation = {"analysis": "simulations", "request": {"q": [0.4], "span": [0, 1]}}
    given: list[tuple[str, dict[str, Any]]] = [("verify", {}), ("analyse", simulation)]
    given += [("export", {"target": target}) for target in ("c", "fmu")]
    for kind, request in given:
        for outcome in outcomes(library, kind, {"items": [{"tree": "governor", **request}]}):
            assert outcome.problem is None, (kind, outcome.problem)
    column = {"quantity": "bias", "of": "g.r", "over": {"q": [0.4]}, "take": "value"}
    choices = {"g": ["table", {"substructure": "table", "at": "world"}]}
    swept = {"template": stored, "choices": choices, "samples": {"of": {"h": {"values": [1, 2]}}}, "proof": 10}
    (item,) = library.items("sweep", {**swept, "columns": {"bias": column}})
    found = sweep.rows_of(sweep.KINDS["sweep"].run(item, library.blobs, lambda _: None).files["rows"])["bias"]
    # -p^2 r/(J + r^2)^2
    np.testing.assert_allclose(found, np.array([-1, -4, -1, -4]) * 0.4 / 0.36**2)
