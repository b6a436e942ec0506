"""Derivations whose steps have the names of mechanics: every named step is that quantity, and the result is right."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pytest

from substructures import Definition, Model, TreeSpec, catalogue, couple, derive, evaluate
from substructures.expr.hoist import hoisted
from substructures.part.part import Part
from substructures.printers import render
from substructures.quantities.formulas import derived
from substructures.tree.glossary import glossary

Numbers = dict[str, float]
LINE = re.compile(r"([A-Za-z_]\w*)(?:\[(\d+), (\d+)\])? = (.*)")


def steps(text: str, values: Numbers) -> tuple[Numbers, dict[tuple[int, int], float]]:
    """The named steps and the elements of the result, computed line by line as a reader would."""
    known: dict[str, Any] = {"sin": math.sin, "cos": math.cos, "sqrt": math.sqrt, "pi": math.pi}
    known |= {name.replace(".", "_DOT_"): value for name, value in values.items()}
    found, result = Numbers(), {}
    for line in text.splitlines():
        if line.startswith("#"):
            continue
        match = LINE.fullmatch(line)
        assert match, line
        formula = re.sub(r"(?<=[A-Za-z0-9_])\.(?=[A-Za-z])", "_DOT_", match[4]).replace("^", "**")
        value = eval(formula, {"__builtins__": {}}, {**known, **found})  # noqa: S307 -- our own formulas
        if match[2]:
            result[int(match[2]) - 1, int(match[3]) - 1] = value
        else:
            assert match[1] not in found, f"{match[1]} is introduced twice"
            found[match[1]] = value
    return found, result


def derivation(spec: TreeSpec, parts: dict[str, Part], model: Model) -> str:
    program = hoisted(model.program.select(["metric"]))
    return render(program, "text", "compact", glossary=glossary(spec, parts))


def single(name: str) -> tuple[TreeSpec, dict[str, Part]]:
    tree = {"name": "t", "gravity": [0, 0, "-9.81"], "instances": [{"name": "arm", "substructure": name}]}
    return TreeSpec.read(tree), {"arm": derive(Definition.read(catalogue.load(name)))}


def values_of(model: Model, q: np.ndarray[Any, Any]) -> Numbers:
    numbers = {name: float(eval(str(p["value"]), {"pi": math.pi})) for name, p in model.parameters.items()}  # noqa: S307
    return numbers | dict(zip(model.coordinates, q.tolist(), strict=True))


@pytest.mark.parametrize("name", ["puma560", "ur5", "kuka-iiwa-14"])
def test_derivation_of_the_metric(name: str) -> None:
    spec, parts = single(name)
    model = couple(spec, parts)
    q = np.linspace(0.3, 1.1, model.dof)
    text = derivation(spec, parts, model)
    values = values_of(model, q)
    found, result = steps(text, values)
    metric = evaluate(model, "metric", q=q)["metric"]
    for (a, b), x in result.items():
        assert x == pytest.approx(metric[a, b], rel=1e-12, abs=1e-14)
    kinematics = evaluate(model, "kinematics", q=q)["kinematics"]
    joints = [f"arm.{body}" for body in parts["arm"]._joint_bodies]
    frames = [model.frames.index(body) for body in joints]
    for label, x in found.items():
        if match := re.fullmatch(r"Omega_(\d)(\d)([xyz])", label):
            c, a, i = int(match[1]) - 1, int(match[2]) - 1, "xyz".index(match[3])
            assert x == pytest.approx(kinematics["Omega"][frames[c], a, i], abs=1e-14), label
        if match := re.fullmatch(r"([cs])(\d+)", label):
            angle = sum(q[int(k) - 1] for k in match[2])
            assert x == pytest.approx(math.cos(angle) if match[1] == "c" else math.sin(angle), abs=1e-14), label
    assert sum(not re.fullmatch(r"t\d+", label) for label in found) >= len(found) / 3


def test_composite_masses_are_those_of_all_that_a_joint_carries() -> None:
    spec, parts = single("puma560")
    model = couple(spec, parts)
    found, _ = steps(derivation(spec, parts, model), values_of(model, np.zeros(6)))
    masses = [float(model.parameters[f"arm.m{k}"]["value"]) for k in range(2, 7)]
    for k in (3, 4, 5):
        assert found[f"m_{k}"] == pytest.approx(sum(masses[k - 2 :]), rel=1e-14)


def test_names_of_the_user_are_not_taken() -> None:
    """A parameter of the tree that is called like a quantity keeps its name, and the quantity has another."""
    spec, parts = single("puma560")
    given = {"m_4": {"value": 0.82, "unit": "kg"}}
    instances = [{"name": "arm", "substructure": "puma560", "parameters": {"m4": "m_4"}}]
    spec = TreeSpec.read({"name": "t", "gravity": [0, 0, "-9.81"], "parameters": given, "instances": instances})
    model = couple(spec, parts)
    found, _ = steps(derivation(spec, parts, model), values_of(model, np.ones(6)))
    assert "m_4" not in found
    assert "m_5" in found


def test_what_letters_mean_is_said() -> None:
    spec, parts = single("puma560")
    model = couple(spec, parts)
    program, names = hoisted(model.program.select(["metric"])), glossary(spec, parts)
    text = render(program, "text", "compact", glossary=names)
    assert "# U: base function of the velocity" in text
    assert "H_{21,z} &=" in render(program, "latex", "compact", glossary=names)
    assert "<msub><mi>H</mi>" in render(program, "mathml", "compact", glossary=names)
    assert render(program, "json", "compact", glossary=names) == render(program, "json", "compact")


def test_parameters_of_instances_keep_their_names() -> None:
    """Where arm.c2 is a length nothing else is called c2."""
    spec, parts = single("scara")
    program = derived(couple(spec, parts), "forward_dynamics")
    text = render(program.select(["forward_dynamics"]), "text", "compact", glossary=glossary(spec, parts))
    assert "arm.m2*arm.c2" in text
    assert "Theta_2zz = " in text
    assert "\nc2 = " not in text
