"""Derivations whose steps have the names of mechanics: every named step is that quantity, and the result is right."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pytest
from catalogue_entries import shipped_part
from in_depth import deep

from substructures import Model, TreeSpec, couple, evaluate
from substructures.export import render
from substructures.expr.hoist import hoisted
from substructures.expr.interpret import interpret
from substructures.part.part import Part
from substructures.printers.meanings import Label
from substructures.quantities.formulas import DERIVED, derived
from substructures.tree.glossary import glossary

Numbers = dict[str, float]
LINE = re.compile(r"([A-Za-z_]\w*)(?:\[([\d, ]+)\])? = (.*)")


def steps(text: str, values: Numbers) -> tuple[Numbers, dict[tuple[int, ...], float]]:
    """The named steps and the elements of the result, computed line by line as a reader would."""
    known: dict[str, Any] = {"sin": math.sin, "cos": math.cos, "sqrt": math.sqrt, "pi": math.pi}
    known |= {_python(name): value for name, value in values.items()}
    found, result = Numbers(), {}
    for line in text.splitlines():
        if line.startswith("#"):
            continue
        match = LINE.fullmatch(line)
        assert match, line
        value = eval(_python(match[3]), {"__builtins__": {}}, {**known, **found})  # noqa: S307 -- our own formulas
        if match[2]:
            result[tuple(int(k) - 1 for k in match[2].split(", "))] = value
        else:
            assert match[1] not in found, f"{match[1]} is introduced twice"
            found[match[1]] = value
    return found, result


def _python(formula: str) -> str:
    """A formula, or a name of a tree or in short, with names that Python has."""
    return formula.removeprefix("arm.").replace("tau.arm.q", "tau_").replace("'", "_dot").replace("^", "**")


def derivation(spec: TreeSpec, parts: dict[str, Part], model: Model) -> str:
    program = hoisted(model.program.select(["metric"]))
    return render(program, "text", "compact", glossary=glossary(spec, parts))


def single(name: str) -> tuple[TreeSpec, dict[str, Part]]:
    tree = {"name": "t", "gravity": [0, 0, "-9.81"], "instances": [{"name": "arm", "substructure": name}]}
    return TreeSpec.read(tree), {"arm": shipped_part(name)}


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
    assert unnamed(found) <= len(found) / 6


def unnamed(found: Numbers) -> int:
    """How many steps have no name but a number."""
    return sum(re.fullmatch(r"t\d+", label) is not None for label in found)


@pytest.mark.parametrize(
    ("quantity", "most"),
    [("inverse_dynamics", 0.15), ("bias", 0.2), ("forward_dynamics", 0.2), ("christoffel", 0.4), ("coriolis", 0.4)],
)
@pytest.mark.parametrize("name", ["puma560", "scara", *deep("kuka-iiwa-14")])
def test_steps_have_names_and_every_named_step_is_that_quantity(name: str, quantity: str, most: float) -> None:
    spec, parts = single(name)
    model = couple(spec, parts)
    program = derived(model, quantity).select([quantity]) if quantity in DERIVED else model.program.select([quantity])
    names = glossary(spec, parts, model=model.program)
    text = render(hoisted(program), "text", "compact", glossary=names)
    values = at(model)
    found, result = steps(text, values)
    expected = interpret(program, {s.name: values[s.name] for s in program.symbols})[quantity]
    for index, x in result.items():
        assert x == pytest.approx(expected[index], rel=1e-9, abs=1e-12)
    told = dict[str, set[float]]()
    for output, value in interpret(names, {s.name: values[s.name] for s in names.symbols}).items():
        key, joints, *component = output.split(" ")
        label = Label(key, tuple(map(int, joints.split("."))), "".join(component))
        told.setdefault(label.text, set()).add(float(value))
    for name_, x in found.items():
        assert name_ not in told or any(x == pytest.approx(y, rel=1e-9, abs=1e-12) for y in told[name_]), name_
    assert unnamed(found) <= max(5, most * len(found))


def at(model: Model) -> Numbers:
    """A state, with velocities, accelerations and inputs."""
    rng = np.random.default_rng(5)
    values = values_of(model, rng.uniform(0.3, 1.1, model.dof))
    for name in model.coordinates:
        values |= {f"{name}'": rng.uniform(0.3, 1.1), f"{name}''": rng.uniform(0.3, 1.1), f"tau.{name}": rng.uniform()}
    return values


def test_motions_and_forces_are_those_of_mechanics() -> None:
    """omega by the base functions, alpha and a by differences in time, f by what all bodies beyond need, n by power."""
    spec, parts = single("puma560")
    model = couple(spec, parts)
    values, names = at(model), glossary(spec, parts)
    known = {k: float(x) for k, x in interpret(names, {s.name: values[s.name] for s in names.symbols}).items()}
    q, u, w = (np.array([values[f"{name}{dots}"] for name in model.coordinates]) for dots in ("", "'", "''"))

    def told(letter: str, joints: str) -> np.ndarray[Any, Any]:
        return np.array([known.get(f"{letter} {joints} {axis}", np.nan) for axis in "xyz"])

    def agree(letter: str, joints: str, expected: np.ndarray[Any, Any], tolerance: float = 1e-9) -> int:
        found = told(letter, joints)
        is_known = ~np.isnan(found)
        np.testing.assert_allclose(found[is_known], expected[is_known], atol=tolerance, err_msg=f"{letter}{joints}")
        return int(is_known.sum())

    frames = [model.frames.index(f"arm.{body}") for body in parts["arm"]._joint_bodies]

    def motion(t: float) -> tuple[np.ndarray[Any, Any], ...]:
        """R, omega and velocity of every body, in the world."""
        state, rates = evaluate(model, "kinematics", q=q + u * t + w * t * t / 2)["kinematics"], u + w * t
        turned = state["rotation"][frames]
        return turned, *(np.einsum("kij,kaj,a->ki", turned, state[x][frames], rates) for x in ("Omega", "U"))

    h = 1e-5
    (turned, omega, _), later, before = motion(0), motion(h), motion(-h)
    alpha, a = ((later[i] - before[i]) / (2 * h) for i in (1, 2))
    count = 0
    for k in range(6):
        back = turned[k].T
        count += agree("omega", str(k + 1), back @ omega[k])
        count += agree("alpha", str(k + 1), back @ alpha[k], 1e-7)
        count += agree("a", str(k + 1), back @ (a[k] + [0, 0, 9.81]), 1e-7)
    assert count > 40
    force = sum((turned[k] @ np.nan_to_num(told("F", str(k + 1))) for k in range(1, 6)), np.zeros(3))
    assert agree("f", "2", turned[1].T @ force) == 3
    needed = evaluate(model, "inverse_dynamics", q=q, qd=u, qdd=w)["inverse_dynamics"]
    for k in range(1, 6):
        rotor = values[f"arm.Jm{k + 1}"] * values[f"arm.G{k + 1}"] ** 2 * w[k]
        assert told("n", str(k + 1))[2] + rotor == pytest.approx(needed[k], abs=1e-9)


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
    """Where c2 is a length nothing else is called c2."""
    spec, parts = single("scara")
    program = derived(couple(spec, parts), "forward_dynamics")
    text = render(program.select(["forward_dynamics"]), "text", "compact", glossary=glossary(spec, parts))
    assert "m2*c2" in text
    assert "Theta_2zz = " in text
    assert "\nc2 = " not in text
