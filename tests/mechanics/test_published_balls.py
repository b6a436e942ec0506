"""Trees with ball and floating joints that become parts: mounted again they are the same, wherever they are mounted."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from ball_trees import GRAVITY, random_balls, random_position
from catalogue_entries import shipped_part
from in_depth import seeds

from substructures import Definition, Model, Part, TreeSpec, catalogue, couple, derive, evaluate
from substructures.tree.publishing.published import Publication, Published, published
from substructures.tree.publishing.published_formulas import published_part

SAME = ("metric", "christoffel", "bias", "forces", "gravity", "inverse_dynamics", "forward_dynamics")


def made(spec: TreeSpec, parts: dict[str, Part]) -> tuple[Published, Part]:
    found = published(spec, parts, Publication({"name": "whole"}))
    return found, published_part(found, parts)


def random_tree(seed: int) -> tuple[TreeSpec, dict[str, Part], np.random.Generator]:
    """Two mechanisms, one on a body of the other, both placed obliquely."""
    (one, rng), (two, _) = random_balls(seed, loads=2), random_balls(seed + 1000, loads=2)
    parts = {"a": derive(Definition.read(one)), "b": derive(Definition.read(two))}
    at = f"a.{rng.choice([body['name'] for body in one['bodies']])}"
    places = [{"position": x[:3], "rpy": x[3:]} for x in np.round(rng.uniform(-1, 1, (2, 6)), 3).tolist()]
    instances = [
        {"name": name, "substructure": parts[name].name, "at": host, "placement": place}
        for name, host, place in zip("ab", ("world", at), places, strict=True)
    ]
    return TreeSpec.read({"name": "t", "gravity": list(GRAVITY), "instances": instances}), parts, rng


def mounted(part: Part, gravity: Any) -> Model:
    tree = {"name": "t", "gravity": gravity, "instances": [{"name": "x", "substructure": part.name}]}
    return couple(TreeSpec.read(tree), {"x": part})


def assert_same(one: Model, other: Model, rng: np.random.Generator) -> None:
    q, (qd, qdd) = random_position(rng, one), rng.uniform(-1, 1, (2, one.dof))
    ours, theirs = (evaluate(model, SAME, q, qd, qdd) for model in (one, other))
    for name in SAME:
        scale = max(1.0, float(np.abs(ours[name]).max(initial=0)))
        np.testing.assert_allclose(theirs[name], ours[name], rtol=0, atol=1e-10 * scale, err_msg=name)


@pytest.mark.parametrize("seed", seeds([1], 30))
def test_a_random_tree_mounted_again_is_the_same(seed: int) -> None:
    spec, parts, rng = random_tree(seed)
    model, (found, part) = couple(spec, parts), made(spec, parts)
    again = mounted(part, list(GRAVITY))
    told = [found.names[name] for name in model.positions]
    assert [name.removeprefix("x.") for name in again.positions] == told
    assert [name.removeprefix("x.") for name in again.coordinates] == [found.names[name] for name in model.coordinates]
    assert_same(model, again, rng)


def test_it_is_mounted_on_others_like_its_parts() -> None:
    """On a rail: the pieces mounted one by one, and all of them as one part, also as derived from the definition."""
    hub = {"name": "hub", "substructure": "ball-hub", "at": "world", "placement": {"rpy": [0.2, 0.3, 0.4]}}
    wheel = {"name": "wheel", "substructure": "furuta-pendulum", "at": "hub.port"}
    inertia = {"xx": 1, "yy": 2, "zz": 2.5}
    body = {"name": "b", "parent": "base", "mass": 2, "joint": {"type": "ball"}, "inertia": inertia}
    ports = [{"name": "port", "body": "b", "position": [0.1, 0, 0.2]}]
    ball = {"name": "ball-hub", "bodies": [body], "ports": ports}
    parts = {"hub": derive(Definition.read(ball)), "wheel": shipped_part("furuta-pendulum")}
    _, part = made(TreeSpec.read({"name": "t", "instances": [hub, wheel]}), parts)
    host = {"name": "rail", "substructure": "linear-rail"}
    port = catalogue.load("linear-rail")["ports"][0]["name"]
    rail = shipped_part("linear-rail")
    loose = couple(
        TreeSpec.read(
            {"name": "loose", "gravity": list(GRAVITY), "instances": [host, {**hub, "at": f"rail.{port}"}, wheel]}
        ),
        {"rail": rail, **parts},
    )
    whole = {"name": "whole", "substructure": "whole", "at": f"rail.{port}"}
    for each in (part, derive(part.definition)):
        tree = TreeSpec.read({"name": "t", "gravity": list(GRAVITY), "instances": [host, whole]})
        assert_same(loose, couple(tree, {"rail": rail, "whole": each}), np.random.default_rng(1))
