"""The shipped substructures: well formed, physical, and derived."""

from __future__ import annotations

import re
from collections.abc import Iterable
from importlib import resources
from typing import Any

import numpy as np
import pytest
from ball_trees import random_position
from catalogue_entries import QUICK
from catalogue_entries import shipped_part as derived
from independent import defaults, value

from substructures import couple
from substructures.catalogue import load, names
from substructures.documents import read_yaml
from substructures.part.definition import Definition
from substructures.part.part import Part
from substructures.part.topology import CHAINS
from substructures.quantities.numbers.evaluation import evaluate
from substructures.tree.document import TreeSpec

ENTRIES = pytest.mark.parametrize("name", names())
#: published moments of inertia that no rigid body can have, kept as published
NOT_PHYSICAL = {("puma560", "link1"), ("puma560", "link3")}


def strings(data: Any) -> list[str]:
    if isinstance(data, dict):
        data = list(data.values())
    if isinstance(data, list):
        return [text for item in data for text in strings(item)]
    return [data] if isinstance(data, str) else []


def test_enough_entries() -> None:
    assert len(names()) >= 54
    assert list(names()) == sorted(names())
    with pytest.raises(KeyError, match="no catalogue entry 'nothing'"):
        load("nothing")


def smallest(some: Iterable[str]) -> dict[tuple[frozenset[str], bool], int]:
    """Degrees of freedom of the smallest entry of each topology: kinds of joints, and whether it branches."""
    found: dict[tuple[frozenset[str], bool], int] = {}
    for name in some:
        moving = [body for body in load(name)["bodies"] if body["joint"]["type"] != "fixed"]
        parents = [body["parent"] for body in moving]
        key = frozenset(body["joint"]["type"] for body in moving), len(set(parents)) < len(parents)
        size = sum(len(CHAINS[body["joint"]["type"]]) for body in moving)
        found[key] = min(size, found.get(key, size))
    return found


def test_the_default_tests_take_the_smallest_entry_of_every_topology() -> None:
    assert smallest(QUICK) == smallest(names())


@ENTRIES
def test_both_readers_of_yaml_agree(name: str) -> None:
    text = (resources.files("substructures.catalogue") / f"{name}.yaml").read_bytes()
    assert read_yaml(text) == read_yaml(text, is_ours=True) == load(name)


@ENTRIES
def test_entry_is_complete(name: str) -> None:
    entry = load(name)
    assert entry["name"] == name
    assert entry["license"] == "CC0-1.0"
    for key in ("title", "description", "source"):
        assert len(entry[key]) >= 10
    assert entry["tags"]
    assert entry["ports"]
    for parameter in entry["parameters"].values():
        assert parameter["unit"]
        assert parameter["description"]
    Definition.read(entry)


@ENTRIES
def test_names_are_used_and_known(name: str) -> None:
    entry = load(name)
    parameters, inputs = set(entry["parameters"]), set(entry.get("inputs", ()))
    words = "placement axis psi theta d sigma phi tau stiffness rest damping armature limits mass com inertia position"
    numeric = f"{words} rotation at vector force length multiplier offset".split()

    def expressions(data: Any) -> list[str]:
        if isinstance(data, list):
            return [text for item in data for text in expressions(item)]
        if not isinstance(data, dict):
            return []
        return [t for key, value in data.items() for t in (strings(value) if key in numeric else expressions(value))]

    texts = [
        text
        for key in ("bodies", "ports", "loads", "relations", "closures")
        for text in expressions(entry.get(key, []))
    ]
    found = {word for text in texts for word in re.findall(r"[A-Za-z]\w*", text)} - {"pi", "sin", "cos", "sqrt"}
    assert found == parameters | inputs


@ENTRIES
def test_default_values_are_physical(name: str) -> None:
    entry = load(name)
    values = defaults(entry)
    for body in entry["bodies"]:
        mass = value(body.get("mass", 0), values)
        assert mass >= 0
        t = {k: value(v, values) for k, v in body.get("inertia", {}).items()}
        xy, xz, yz = (t.get(k, 0.0) for k in ("xy", "xz", "yz"))
        moments = np.linalg.eigvalsh(
            [[t.get("xx", 0.0), xy, xz], [xy, t.get("yy", 0.0), yz], [xz, yz, t.get("zz", 0.0)]]
        )
        physical = moments[0] >= 0 and moments[0] + moments[1] >= moments[2] * (1 - 1e-12)
        assert physical != ((name, body["name"]) in NOT_PHYSICAL)


@pytest.fixture(scope="module", params=names())
def part(request: pytest.FixtureRequest) -> Part:
    return derived(request.param)


def test_entry_derives(part: Part) -> None:
    assert part.dof == len(part.coordinates) == len(part.joints)
    # neither doubtful units nor parameters without effect
    assert {warning["code"] for warning in part.certificate["warnings"]} <= {"impossible-inertia"}
    assert part.ports == tuple(port["name"] for port in load(part.name)["ports"])
    assert Part.load(part.definition, part.program.to_bytes(), part.certificate).program == part.program


def test_metric_is_positive_definite_at_the_default_values(part: Part) -> None:
    instance = {"name": "x", "substructure": part.name, "level": "full"}
    model = couple(TreeSpec.read({"name": "one", "instances": [instance]}), {"x": part})
    if not part.dof:
        assert model.coordinates == ()
        return
    rng = np.random.default_rng(5)
    q = np.array([random_position(rng, model) for _ in range(3)])
    answer = evaluate(model, ["metric", "forces"], q=q, qd=rng.uniform(-1, 1, (3, part.dof)))
    assert np.all(np.linalg.eigvalsh(np.array(answer["metric"])) > 0)
    assert np.isfinite(np.array(answer["forces"])).all()
