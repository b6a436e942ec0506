"""Scenes and pictures: the bodies that are drawn have the metric of the model, and can be seen, whatever it is."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
import pytest
from ball_trees import random_balls, random_position
from catalogue_entries import all_entries, shipped_part
from in_depth import seeds

from substructures import Definition, catalogue, couple, derive
from substructures.documents import read_json
from substructures.errors import InvalidDocument
from substructures.part.part import Part
from substructures.pictures.plane import HEIGHT, WIDTH, plane
from substructures.pictures.pose import kinematics
from substructures.pictures.scene import scene
from substructures.pictures.tree import AXES, COLOURS, INK, picture
from substructures.quantities.numbers.evaluation import evaluate
from substructures.tree.document import TreeSpec
from substructures.tree.model import Model
from substructures.tree.publishing.published import Publication, published

Drawn = tuple[TreeSpec, Mapping[str, Part], Model]
PENDULUM: dict[str, Any] = {
    "name": "p",
    "parameters": {"m": {"value": 2, "unit": "kg"}, "l": {"value": 0.5, "unit": "m"}},
    "bodies": [
        {
            "name": "rod",
            "parent": "base",
            "joint": {"type": "revolute", "coordinate": "q"},
            "mass": "m",
            "com": ["l", 0, 0],
        }
    ],
    "ports": [{"name": "tip", "body": "rod", "position": ["l", 0, 0]}],
}


def alone(part: Part) -> Drawn:
    spec = TreeSpec.read({"name": "alone", "instances": [{"name": "p", "substructure": part.name}]})
    return spec, {"p": part}, couple(spec, {"p": part})


@cache
def humanoid() -> Drawn:
    spec = TreeSpec.read(catalogue.load_tree("humanoid"))
    parts = {each.name: shipped_part(str(each.substructure)) for each in spec.instances}
    return spec, parts, couple(spec, parts)


def with_poses(**poses: Any) -> Definition:
    return Definition.read({**PENDULUM, "poses": poses})


def metric_of_bodies(found: Mapping[str, Any], shown: Mapping[str, Any], n: int) -> Any:
    """g_ab = sum over bodies of m u_a . u_b + Omega_a . J Omega_b, u_a of mass centres, all in axes of the bodies."""
    g = np.zeros((n, n))
    for body in found["bodies"]:
        k = body["frame"]
        omega, axes = shown["Omega"][k], np.array(body["axes"])
        u = shown["U"][k] + np.cross(omega, np.array(body["centre"]))
        inertia = axes @ np.diag(body["moments"]) @ axes.T
        g += body["mass"] * u @ u.T + omega @ inertia @ omega.T
    return g


@pytest.mark.parametrize("name", all_entries())
def test_the_bodies_of_a_scene_have_the_metric_of_the_model(name: str) -> None:
    _, _, model = drawn = alone(shipped_part(name))
    found = scene(*drawn)
    q = found["poses"]["home"]
    g = metric_of_bodies(found, kinematics(model, q), model.dof)
    expected = evaluate(model, "metric", q)["metric"]
    armature = np.diag(expected - g) if name in WITH_ARMATURE else np.zeros(model.dof)
    np.testing.assert_allclose(g + np.diag(armature), expected, atol=1e-12 * max(1.0, np.abs(expected).max(initial=0)))
    assert (armature >= -1e-15 * np.abs(expected).max(initial=0)).all()
    at = dict(zip(found["positions"], q, strict=True))
    assert [j["home"] for j in found["joints"]] == [at.get(j["coordinate"], 0) for j in found["joints"]]
    assert all(j["limits"] is None or j["limits"][0] <= j["home"] <= j["limits"][1] for j in found["joints"])


#: entries whose joints have rotors of their own
WITH_ARMATURE = {name for name in catalogue.names() if "armature" in str(catalogue.load(name))}


def boxes(svg: str) -> Any:
    """Ends of lines and centres of bodies."""
    lines = re.findall(r'<line x1="([-\d.]+)" y1="([-\d.]+)" x2="([-\d.]+)" y2="([-\d.]+)"', svg)
    points = [p for a, b, c, d in lines for p in ((a, b), (c, d))]
    bodies = re.findall(r'translate\(([-\d.]+) ([-\d.]+)\) rotate\([-\d.]+\)" rx="([-\d.]+)"[^>]*><title>', svg)
    # a circle of the long half axis is as wide as the body or wider
    points += [(float(x) + s * float(r), float(y) + s * float(r)) for x, y, r in bodies for s in (-1, 1)]
    return np.array(points, float)


@pytest.mark.parametrize("seed", seeds([7], 20))
def test_mechanisms_with_balls_are_drawn_at_any_state(seed: int) -> None:
    definition, rng = random_balls(seed)
    for body in definition["bodies"]:
        body["joint"].pop("armature", None)
    _, _, model = drawn = alone(derive(Definition.read(definition)))
    q, found = random_position(rng, model), scene(*drawn)
    expected = evaluate(model, "metric", q)["metric"]
    np.testing.assert_allclose(
        metric_of_bodies(found, kinematics(model, q), model.dof), expected, atol=1e-12 * expected.max()
    )
    home = dict(zip(found["positions"], found["poses"]["home"], strict=True))
    assert all(home[name] == name.endswith("_w") for ball in model.balls for name in ball["positions"])
    assert [joint["coordinate"] for joint in found["joints"]] == list(model.coordinates)
    assert str(picture(*drawn, q)) != str(picture(*drawn))


def test_poses_name_the_place_of_a_floating_joint_and_no_rates() -> None:
    body = {
        "name": "b",
        "parent": "base",
        "mass": 1,
        "inertia": {"xx": 1, "yy": 1, "zz": 1},
        "joint": {"type": "floating"},
    }
    stands = {"name": "x", "bodies": [body], "poses": {"home": {"r_b_z": {"value": 90, "unit": "cm"}}}}
    found = scene(*alone(derive(Definition.read(stands))))
    assert found["poses"]["home"] == [0, 0, 0.9, 1, 0, 0, 0]
    for name in ("v_b_x", "w_b_x", "q_b_w"):
        with pytest.raises(InvalidDocument, match=f"there is no coordinate '{name}'"):
            derive(Definition.read({**stands, "poses": {"home": {name: 1}}}))


@pytest.mark.parametrize("name", [*all_entries(), "humanoid"])
def test_every_body_with_mass_is_seen(name: str) -> None:
    spec, parts, model = humanoid() if name == "humanoid" else alone(shipped_part(name))
    svg = picture(spec, parts, model)
    massive = [f"{i}.{b.name}" for i, part in parts.items() for b in part.definition.bodies if b.mass != 0]
    assert set(massive) <= set(re.findall(r"<title>([^<]+)</title></ellipse>", svg))
    points = boxes(svg)
    assert "nan" not in svg
    assert (np.ptp(points, axis=0) / [WIDTH, HEIGHT]).max() >= 0.4
    found = plane(scene(spec, parts, model), kinematics(model, scene(spec, parts, model)["poses"]["home"]))
    for body in found.bodies:
        assert (body.centre >= 0).all()
        assert (body.centre <= [WIDTH, HEIGHT]).all()


def test_a_humanoid_is_a_person() -> None:
    found = scene(*humanoid())
    shown = kinematics(humanoid()[2], found["poses"]["home"])
    at = {
        body["name"]: shown["position"][body["frame"]] + shown["rotation"][body["frame"]] @ body["centre"]
        for body in found["bodies"]
    }
    heights = [
        at[name][2] for name in ("head.head", "pelvis.pelvis", "left_leg.thigh", "left_leg.shank", "left_leg.foot")
    ]
    assert heights == sorted(heights, reverse=True)
    assert at["head.head"][2] - at["left_leg.foot"][2] == pytest.approx(1.6, abs=0.1)
    for left in (name for name in at if name.startswith("left")):
        np.testing.assert_allclose(at[left], at[left.replace("left", "right")] * [1, -1, 1], atol=1e-12)


def test_a_free_body_is_free_and_a_gyroscope_shows_its_gimbals() -> None:
    svg = picture(*alone(shipped_part("free-body")))
    assert "<path" not in svg
    assert 'stroke-linecap="round"' not in svg
    outlines = re.findall(
        r'rotate\(([-\d.]+)\)" rx="[-\d.]+"[^>]*><title>', picture(*alone(shipped_part("gimbal-gyroscope")))
    )
    assert len(set(outlines)) == 3


def test_colours_are_told_from_light_and_dark_paper() -> None:
    def luminance(colour: str) -> float:
        """WCAG 2.2."""
        parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
        linear = [x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4 for x in parts]
        return float(np.dot((0.2126, 0.7152, 0.0722), linear))

    for colour in (*COLOURS, *AXES, INK):
        for paper in ("#ffffff", "#14171a", "#1c2024", "#f6f7f9"):
            light, dark = sorted((luminance(colour), luminance(paper)), reverse=True)
            assert (light + 0.05) / (dark + 0.05) >= 3


def test_poses_are_kept_and_shown() -> None:
    part = derive(with_poses(home={"q": {"value": 90, "unit": "deg"}}, folded={"q": "-pi/4"}, zero={}))
    assert scene(*alone(part))["poses"] == {"home": [np.pi / 2], "folded": [-np.pi / 4], "zero": [0.0]}
    assert Definition.read(read_json(part.definition.canonical())) == part.definition
    spec, parts, model = alone(part)
    assert picture(spec, parts, model) == picture(spec, parts, model, [np.pi / 2])
    assert part.shape == derive(Definition.read(PENDULUM)).shape
    tree = TreeSpec.read(
        {
            "name": "two",
            "instances": [{"name": n, "substructure": "p", "at": at} for n, at in (("a", "world"), ("b", "a.tip"))],
        }
    )
    whole = published(
        tree, {"a": part, "b": derive(Definition.read(PENDULUM))}, Publication({"name": "two"})
    ).definition
    assert scene(*alone(derive(whole)))["poses"]["folded"] == [-np.pi / 4, 0.0]


@pytest.mark.parametrize(
    ("pose", "code", "pointer"),
    [
        ({"p": 1}, "unknown-coordinate", "/poses/home/p"),
        ({"q": "l"}, "unknown-name", "/poses/home/q"),
        ({"q": {"value": 1, "unit": "m"}}, "unit-mismatch", "/poses/home/q"),
        ({"q": "1 +"}, "bad-expression", "/poses/home/q"),
    ],
)
def test_wrong_poses(pose: Any, code: str, pointer: str) -> None:
    with pytest.raises(InvalidDocument) as caught:
        derive(with_poses(home=pose))
    assert [(fault.code, fault.pointer) for fault in caught.value.faults] == [(code, pointer)]


def test_bodies_that_would_coincide_are_moved_apart() -> None:
    """A slider at 0 would lie in its base; within limits that exclude 0 the middle is shown."""
    for joint, home in (({"type": "prismatic"}, [0.25]), ({"type": "revolute", "limits": [1, 2]}, [1.5])):
        body = {"name": "rod", "parent": "base", "joint": joint, "mass": 1}
        assert scene(*alone(derive(Definition.read({"name": "p", "bodies": [body]}))))["poses"]["home"] == home
