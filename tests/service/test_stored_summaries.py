"""Summaries of trees are stored in two parts: what trees of one shape have in common, once, and the values of each."""

from __future__ import annotations

import json
import sqlite3
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from service.app import open_store
from service.content.integrity import digest_of
from service.content.tree_summaries import HOLE, summary_text, tree_summary
from service.operations.renewing import Renewal
from service.operations.verification import verify_all
from service.settings import Settings
from substructures import Part, TreeSpec, couple, derive
from substructures.documents import read_json, write_json

from .conftest import HAND, PENDULUM, TREE, make_client
from .test_old_stores import unpacked

LOAD = {"type": "spring", "name": "rope", "from": "world", "to": "arm.tip", "stiffness": "k", "length": 1}
LOADED = {**TREE, "loads": [LOAD], "parameters": {**TREE["parameters"], "k": {"value": 3, "unit": "N/m"}}}
BOUND = {**TREE, "instances": [{**TREE["instances"][0], "parameters": {"m": 3, "l": "0.25"}}]}


@pytest.fixture(scope="module")
def pendulum() -> Part:
    return derive(PENDULUM)


@pytest.mark.parametrize("document", [TREE, LOADED, BOUND, {**TREE, "instances": []}])
@pytest.mark.parametrize("description", ["", HOLE, f'"{HOLE}"', "=1:2\n=3:4"])
def test_both_parts_together_are_the_summary(document: dict[str, Any], description: str, pendulum: Part) -> None:
    told = {name: {**each, "description": description} for name, each in document.get("parameters", {}).items()}
    spec = TreeSpec.stored({**document, "parameters": told})
    model = couple(spec, {instance.name: pendulum for instance in spec.instances})
    given = read_json(spec.canonical())
    shown = {"gravity": given.get("gravity", [0, 0, 0]), "instances": given.get("instances", [])}
    whole = {**model.summary(), **shown, **({"loads": given["loads"]} if "loads" in given else {})}
    made = tree_summary(spec, model)
    assert summary_text(made.values, made.form, spec.canonical().decode()).encode() == write_json(whole)
    assert made.digest == digest_of(write_json(whole))
    assert (made.form is None) == (description == HOLE and bool(told))


def test_trees_of_one_shape_have_a_form_in_common(tmp_path: Path) -> None:
    path, answers = tmp_path / "store.db", {}
    with open_store(Settings(database=f"sqlite:///{path}", catalogue=False)) as store:
        client = make_client(store)
        assert client.post("/v1/substructures", json=PENDULUM).status_code == 201
        for k in range(4):
            parameters = {"g": {"value": 9810 + 1000 * k, "unit": "mm/s^2"}}
            arm, hand = {**TREE["instances"][0], "parameters": {"m": 2 + k}}, {**HAND, "parameters": {}}
            tree = {**TREE, "name": f"t{k}", "parameters": parameters, "instances": [arm, hand]}
            assert client.post("/v1/trees", json=tree).status_code == 201
            answers[k] = client.get(f"/v1/trees/t{k}").json()
        assert [finding for finding in verify_all(store.database) if finding.fault] == []
    for k, answer in answers.items():
        assert (answer["parameters"]["g"]["value"], answer["numbers"]) == (round(9.81 + k, 2), {"arm.m": str(2 + k)})
        assert answer["instances"][0]["parameters"] == {"m": 2 + k}
    with closing(sqlite3.connect(path)) as connection:
        ((form,),) = connection.execute("SELECT content FROM summary_forms").fetchall()
        for number, values in connection.execute("SELECT substr(name, 2), summary_values FROM trees"):
            whole = write_json({name: answers[int(number)][name] for name in json.loads(form)})
            assert len(values) < len(whole) / 4


def test_what_is_stored_whole_is_stored_in_parts_when_it_is_coupled_anew(tmp_path: Path) -> None:
    path = unpacked("0017", tmp_path)
    query = "SELECT summary_form IS NULL FROM trees"
    with open_store(Settings(database=f"sqlite:///{path}", catalogue=False, key_seconds=0)) as store:
        with closing(sqlite3.connect(path)) as connection:
            assert {old for (old,) in connection.execute(query)} == {1}
        assert Renewal(store).all() == 0
    with closing(sqlite3.connect(path)) as connection:
        assert {old for (old,) in connection.execute(query)} == {0}
