"""Refusals say what there is instead."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from fastapi.testclient import TestClient

from service.app import open_store
from service.models.numbers import ANALYSES
from service.settings import Limits, Settings, SettingsError, from_environment

from .conftest import PENDULUM, TREE, make_client


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    database = f"sqlite:///{tmp_path_factory.mktemp('ways') / 'store.db'}"
    with open_store(Settings(database=database, catalogue=False, limits=Limits(json_bytes=5000))) as store:
        found = make_client(store)
        assert found.post("/v1/substructures", json=PENDULUM).is_success
        assert found.post("/v1/trees", json=TREE).is_success
        yield found


@pytest.mark.parametrize(("name", "said"), [("linearisation", "did you mean 'linearisations'?"), ("xyz", "there are ")])
def test_an_analysis_that_does_not_exist(client: TestClient, name: str, said: str) -> None:
    answer = client.post(f"/v1/trees/cell/{name}", json={"q": [0]})
    assert (answer.status_code, answer.json()["code"]) == (404, "unknown-analysis")
    assert said in answer.json()["detail"]


def test_the_list_has_every_analysis(client: TestClient) -> None:
    told = client.post("/v1/trees/cell/xyz", json={}).json()["detail"]
    assert f"({len(ANALYSES)}" not in told
    assert told.startswith("POST knows no 'xyz' at this path; there are abbreviations, ")
    # what exists with another method is told as before
    assert client.post("/v1/trees/cell", json={}).status_code == 405
    assert client.get("/v1/trees/cell/evaluations").status_code in (404, 405)


def test_a_body_that_is_too_large_has_a_way_out(client: TestClient) -> None:
    answer = client.post("/v1/trees/cell/evaluations", json={"quantities": ["metric"], "q": [[0.0]] * 5000})
    assert answer.status_code == 413
    assert all(word in answer.json()["detail"] for word in ("npz", "Arrow", "/v1/jobs"))


def test_a_unit_that_is_not_known_has_candidates(client: TestClient) -> None:
    for unit, said in (("furlongz", "; "), ("qqq", "there are for example mm, deg")):
        wrong = {**PENDULUM, "parameters": {**PENDULUM["parameters"], "l": {"value": 1, "unit": unit}}}
        answer = client.post("/v1/substructures", json=wrong)
        assert answer.status_code == 422
        assert said in answer.json()["detail"]


def test_a_setting_that_is_not_known_has_candidates() -> None:
    with pytest.raises(SettingsError, match=r"SYNC_SECONDS: .*did you mean 'SUBSTRUCTURES_LIMIT_SYNC_SECONDS'"):
        from_environment({"SUBSTRUCTURES_SYNC_SECONDS": "3"})


def test_a_file_is_a_database(tmp_path: Path) -> None:
    found = from_environment({}, database="models.db")
    assert found.database == "sqlite:///models.db"
    assert found.kernel_folder == Path("models.db.kernels")
    whole = tmp_path / "store.db"
    with open_store(from_environment({}, database=str(whole), catalogue=False)):
        assert whole.exists()
