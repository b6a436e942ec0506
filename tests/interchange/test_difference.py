"""How two parts or trees differ: fields, formulas by fingerprint, numbers at the defaults, and the words about them."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest
from catalogue_entries import shipped_part

from substructures import Definition, Model, Part, TreeSpec, catalogue, couple, derive, evaluate
from substructures.interchange.difference.difference import Difference, of_parts, of_trees
from substructures.interchange.difference.documents import applied, changes

PUMA = catalogue.load("puma560")
ARM = derive(Definition.read(PUMA))


def changed(**values: Any) -> dict[str, Any]:
    """Puma 560 with other default values."""
    document = copy.deepcopy(PUMA)
    for name, value in values.items():
        document["parameters"][name]["value"] = value
    return document


def difference(document: dict[str, Any]) -> Difference:
    return of_parts(ARM, derive(Definition.read(document)))


def quantity(found: Difference, name: str) -> dict[str, Any]:
    told: dict[str, Any] = found.plain()["quantities"][name]
    return told


def metric(part: Part, q: Any) -> Any:
    tree = TreeSpec.read({"name": "x", "instances": [{"name": "x", "substructure": "puma560"}]})
    return np.asarray(evaluate(couple(tree, {"x": part}), "metric", q=q)["metric"])


def test_percents_are_numbers_that_people_read() -> None:
    (words,) = difference(changed(m3=9.6)).words
    assert "e+0" not in words
    assert "at most 100 %" in difference_of_pendulum(1, 2)
    assert "at most 12 %" in difference_of_pendulum(1, "1.124")
    assert "at most 0.12 %" in difference_of_pendulum(1, "1.00124")


def difference_of_pendulum(m: Any, to: Any) -> str:
    body = {
        "name": "b",
        "parent": "base",
        "joint": {"type": "revolute", "coordinate": "q"},
        "mass": "m",
        "com": [1, 0, 0],
    }
    a, b = (
        derive(Definition.read({"name": "p", "parameters": {"m": {"value": value}}, "bodies": [body]}))
        for value in (m, to)
    )
    (words,) = of_parts(a, b).words
    return words


def test_another_default_changes_numbers_and_no_formula() -> None:
    """Which entries, and by how much at most, is found once more by evaluating both."""
    found = difference(changed(m3=5.1))
    told = quantity(found, "metric")
    heavy = derive(Definition.read(changed(m3=5.1)))
    q = np.random.default_rng(0).uniform(-1.5, 1.5, (400, 6))
    a, b = metric(ARM, q), metric(heavy, q)
    scale = np.maximum(np.abs(a).max(axis=0), 1e-6 * np.abs(a).max())
    apart = np.tril(np.abs(b - a).max(axis=0) / scale)
    assert (told["entries"], told["equal"], told["changed"]) == (21, 21, 0)
    assert told["moved"] == (apart > 1e-12).sum()
    assert told["change"] == pytest.approx(apart.max(), rel=0.3)
    assert {tuple(sorted(each["place"])) for each in told["differing"]} == {
        tuple(sorted((f"q{i + 1}", f"q{j + 1}"))) for i, j in zip(*np.nonzero(apart > 1e-12), strict=True)
    }
    assert found.words == (
        f"parameter m3 4.8 -> 5.1 kg: changes {told['moved']} of 21 entries of M, at most 3 %; "
        f"{quantity(found, 'christoffel')['moved']} of 70 entries of Gamma, at most 2.9 %",
    )


def test_each_change_is_told_with_what_it_does_alone() -> None:
    document = changed(m3=5.1)
    document |= {"title": "another"}
    document["bodies"][1]["mass"] = "2*m2"
    document["ports"][0]["position"] = [0, 0, 0.3]
    words = difference(document).words
    assert [line.partition(":")[0] for line in words] == [
        "mass of link2 m2 -> 2*m2",
        "parameter m3 4.8 -> 5.1 kg",
        "position of port elbow [a2, 0, 0] -> [0, 0, 0.3]",
        "title Unimation Puma 560 -> another",
        "together",
    ]
    alone = difference(changed(m3=5.1)).words[0]
    assert words[1] == alone
    assert words[2].endswith("changes no numbers of the equations of motion at the defaults")


def test_a_default_that_is_gone_or_new_has_no_size() -> None:
    document = copy.deepcopy(PUMA)
    del document["parameters"]["m3"]["value"]
    open_arm = derive(Definition.read(document))
    found = of_parts(ARM, open_arm)
    assert found.words == ("default of m3 4.8 kg -> none",)
    assert all(not each.differing for each in found.quantities)
    assert of_parts(open_arm, ARM).words == ("default of m3 none -> 4.8 kg",)
    document["parameters"]["m2"]["value"] = 17.5
    default, other = difference(document).words
    assert {default.partition(":")[0], other.partition(":")[0]} == {
        "parameter m2 17.4 -> 17.5 kg",
        "default of m3 4.8 kg -> none",
    }


def test_sizes_are_not_made_of_random_numbers() -> None:
    """Where a parameter has no default on either side nothing is known about how much a change does."""
    document = copy.deepcopy(PUMA)
    document["parameters"]["m9"] = {"unit": "kg"}
    document["bodies"][1]["mass"] = "m9"
    found = difference(document)
    assert quantity(found, "metric")["moved"] > 0
    assert quantity(found, "metric")["change"] is None
    assert not any("%" in line or "tenfold" in line for line in found.words)


def test_parts_of_different_size_are_compared_in_what_both_have() -> None:
    document = copy.deepcopy(PUMA)
    document["bodies"][0]["mass"] = 100
    tip = {"type": "revolute", "coordinate": "q7"}
    document["bodies"].append({"name": "tip", "parent": "link6", "joint": tip, "mass": "1/100", "com": [0, "1/10", 0]})
    first, *_, last = difference(document).words
    assert first == "coordinates 6 -> 7 (q7 new), compared in q1, q2, q3, q4, q5, q6"
    assert last.startswith("together: changes entries of M, ")
    alone = shipped_part("compound-pendulum")
    apart = of_parts(ARM, alone).words
    assert apart[0].startswith("coordinates 6 -> 1 (")
    assert apart[0].endswith("), with none in common to compare in")
    assert not any(line.startswith("together") for line in apart)


def test_a_unit_is_told_on_both_sides() -> None:
    document = copy.deepcopy(PUMA)
    document["parameters"]["m3"]["value"] = {"value": 4900, "unit": "g"}
    assert difference(document).words[0].startswith("parameter m3 4.8 kg -> 4900 g: changes ")


def test_formulas_by_fingerprint() -> None:
    """The same function, written in another way, is equal; one that is not is told by the names of its place."""
    document = copy.deepcopy(PUMA)
    document["bodies"][1]["mass"] = "2*m2 - m2*(sin(0.3)^2 + cos(0.3)^2)"
    found = difference(document)
    assert all(not each.differing for each in found.quantities)
    assert found.words[0].startswith("mass of link2 m2 -> ")
    document["bodies"][1]["mass"] = "m2 + m3"
    told = quantity(difference(document), "metric")
    assert 0 < told["changed"] == told["moved"] < 21
    assert {"place": ["q1", "q1"], "state": "changed"}.items() <= told["differing"][0].items()


def test_a_joint_more_does_not_shift_the_others() -> None:
    document = copy.deepcopy(PUMA)
    joint = {"type": "revolute", "coordinate": "q0"}
    document["bodies"].insert(0, {"name": "turntable", "parent": "base", "joint": {"type": "fixed"}, "mass": 3})
    found = difference(document)
    assert quantity(found, "metric")["equal"] == 21
    document["bodies"].append(
        {"name": "more", "parent": "turntable", "joint": joint, "inertia": {"xx": 0.1, "yy": 0.1, "zz": 0.2}}
    )
    told = quantity(difference(document), "metric")
    assert [(each["place"], each["state"]) for each in told["differing"]] == [(["q0", "q0"], "new")]


def test_nothing_differs() -> None:
    found = difference(copy.deepcopy(PUMA))
    assert (found.is_none, found.words) == (True, ("nothing differs",))
    same = changed(m3={"value": 4800, "unit": "g"})
    assert all(not each.differing for each in difference(same).quantities)


def tree(**parameters: Any) -> tuple[TreeSpec, Model]:
    hand = {"name": "hand", "substructure": "parallel-gripper", "at": "arm.flange", "parameters": parameters}
    spec = TreeSpec.read(
        {"name": "cell", "gravity": [0, 0, "-9.81"], "instances": [{"name": "arm", "substructure": "puma560"}, hand]}
    )
    return spec, couple(spec, PARTS)


PARTS = {"arm": ARM, "hand": shipped_part("parallel-gripper")}


def test_trees() -> None:
    found = of_trees(tree(mp=0.4), tree(mp=0.5), [])
    (words,) = found.words
    assert words.startswith("parameters mp of instance hand 0.4 -> 0.5: changes ")
    told = quantity(found, "forces")
    assert 0 < told["moved"] <= told["entries"] == 8
    (bound,) = of_trees(tree(), tree(mp=0.5), []).words
    assert bound.startswith("parameters mp of instance hand is new: 0.5: changes ")
    heavy = derive(Definition.read(changed(m3=5.1)))
    nested = of_trees(tree(mp=0.4), tree(mp=0.4), [("arm", ARM, heavy)])
    assert nested.definition[0].place == "/instances/arm/definition/parameters/m3/value"
    assert nested.words[0].startswith("in instance arm: parameter m3 4.8 -> 5.1 kg")


def test_where_an_instance_is_mounted() -> None:
    arms = [{"name": name, "substructure": "puma560"} for name in ("a", "b")]
    moved = TreeSpec.read({"name": "x", "instances": [arms[0], {**arms[1], "at": "a.elbow"}]})
    still = TreeSpec.read({"name": "x", "instances": arms})
    model = couple(still, {"a": ARM, "b": ARM})
    (words,) = of_trees((still, model), (moved, model), []).words
    assert words.startswith("instance b: at world -> a.elbow: ")


def test_parts_of_trees_are_told_by_their_versions() -> None:
    digests = {"arm@sha256:" + 64 * digit: f"arm@{digit}" for digit in "12"} | {"leg@sha256:" + 64 * "3": "leg@7"}
    specs = [
        TreeSpec.read({"name": "x", "instances": [{"name": "a", "substructure": reference}]}) for reference in digests
    ]
    model = couple(specs[0], {"a": ARM})
    one, two, leg = ((spec, model) for spec in specs)
    assert of_trees(one, two, [], digests.__getitem__).words == (
        "instance a: arm version 1 -> 2: changes no numbers of the equations of motion at the defaults",
    )
    (words,) = of_trees(one, leg, [], digests.__getitem__).words
    assert words.startswith("instance a: part arm@1 -> leg@7: ")
    (unknown,) = of_trees(one, two, []).words
    assert unknown.startswith("instance a: arm version sha256:11111111... -> sha256:22222222...: ")


def test_changes_lead_from_one_document_to_the_other() -> None:
    """Made one after the other they make the second document of the first, for whatever was changed."""
    rng = np.random.default_rng(4)
    for _ in range(40):
        document = copy.deepcopy(PUMA)
        for body in rng.choice(6, 2, replace=False):
            document["bodies"][body]["mass"] = float(rng.integers(1, 9))
            document["bodies"][body]["com"] = [0, float(rng.integers(0, 3)), "a2"]
        document["parameters"].pop(str(rng.choice(list(document["parameters"]))))
        document["tags"] = ["other"]
        document["ports"] = document["ports"][: rng.integers(0, 3)]
        made: dict[str, Any] = copy.deepcopy(PUMA)
        for change in changes(PUMA, document):
            made = applied(made, change)
        assert changes(made, document) == []


def test_given_motions_differ_by_what_they_are_later() -> None:
    """Twice t^4 is twice as much, though both are 0 at t = 0."""
    lift = {"name": "lift", "bodies": [
        {"name": "b", "parent": "base", "mass": 1, "joint": {"type": "prismatic", "coordinate": "z"}},
        {"name": "r", "parent": "b", "mass": 2, "com": [0, 1, 0], "joint": {"type": "revolute", "coordinate": "q"}},
    ]}  # fmt: skip

    def driven(motion: str) -> tuple[TreeSpec, Model]:
        instances = [{"name": "a", "substructure": "lift"}]
        spec = TreeSpec.read({"name": "t", "instances": instances, "driven": {"a.z": motion}})
        return spec, couple(spec, {"a": derive(lift)})

    told = quantity(of_trees(driven("t^4"), driven("2*t^4"), []), "g_00")
    assert told["change"] == pytest.approx(3)
