"""Models with velocity constraints as C and FMUs, in independent velocities: they move as here."""

from __future__ import annotations

import io
import subprocess
import zipfile
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from closed_trees import tree_model, tree_parts
from random_trees import Plain
from rolling_bodies import FRONT, REAR, R, bicycle_part, disc_part, sleigh_part
from run_code import STRICT, tool

from service.models.exporting import ExportRequest, Package, tree_package
from service.models.formulas import makers
from service.models.source import Source
from service.settings import Limits
from substructures import ConstrainedMotion, Model, simulate
from substructures.analysis.equations.nonholonomic.velocity_constraints import closing
from substructures.analysis.simulate import Outputs
from substructures.errors import InvalidInput
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.sources import Sources

fmpy = pytest.importorskip("fmpy", reason="the wheel FMPy is not installed")
from fmpy.validation import validate_fmu  # noqa: E402

from .fmu_instances import instance  # noqa: E402

EDGE = {"name": "blade", "type": "knife_edge", "frame": "s.b"}
FLOOR = {"name": "floor", "type": "rolling", "frame": "s.disc", "radius": "s.r"}
WHEELS = [
    {"name": "rear", "type": "rolling", "frame": "s.rear_axle", "radius": REAR},
    {"name": "front", "type": "rolling", "frame": "s.front_axle", "radius": FRONT},
]
TREES: dict[str, tuple[Plain, list[Plain]]] = {
    "sleigh": (sleigh_part(), [EDGE]),
    "disc": (disc_part(), [FLOOR]),
    "bicycle": (bicycle_part(), WHEELS),
}
#: starts, and velocities by the name of a coordinate
STARTS: dict[str, tuple[Plain, Plain]] = {
    "sleigh": ({"s.f": 0.4}, {"s.x": 1.5, "s.f": 1.0}),
    "disc": ({"s.z": R * np.sin(1.2), "s.psi": 0.2, "s.th": 1.2}, {"s.psi": 1.0, "s.th": 0.3, "s.ph": -6.0}),
    "bicycle": ({"s.z": REAR}, {"s.lean": 0.2, "s.steer": -0.1, "s.rear": 5 / REAR}),
}
SPAN = (0.0, 0.5)
TREE: Plain = {"gravity": [0, 0, -9.81], "instances": [{"name": "s", "substructure": "p"}]}
QUANTITIES = ("kinetic_energy", "position", "inverse_dynamics")


def tied(name: str) -> Model:
    part, constraints = TREES[name]
    return tree_model({**TREE, "velocity_constraints": constraints}, {"p": part})


def package(called: str, **request: Any) -> Package:
    part, constraints = TREES[called]
    document = {**TREE, "velocity_constraints": constraints}
    source, asked = Source(Sources(tied(called)), "", Limits()), ExportRequest(**request)
    more = partial(tree_parts, document, {"p": part}), makers(source, asked.independent)
    return tree_package(source.sources, "tied", "tied@1", "sha256:1", asked, 10**6, *more)


def start_of(name: str, model: Model) -> tuple[np.ndarray[Any, Any], Plain]:
    """q, and v by coordinate."""
    q, v = STARTS[name]
    return np.array([q.get(c, 0.0) for c in model.coordinates]), v


Made = Callable[[str, str], tuple[Model, Path]]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Made:
    folder = tmp_path_factory.mktemp("fmu")

    @cache
    def one(name: str, fmi: str) -> tuple[Model, Path]:
        """In the velocities of the start."""
        path = folder / f"{name}{fmi[0]}.fmu"
        given: Plain = {"quantities": QUANTITIES, "independent": (*STARTS[name][1],)}
        path.write_bytes(package(name, target="fmu", name="tied", fmi=fmi, **given).data)
        return tied(name), path

    return one


@pytest.mark.parametrize("fmi", ["3.0", "2.0"])
@pytest.mark.parametrize("name", TREES)
def test_it_is_valid_and_moves_as_here(made: Made, name: str, fmi: str) -> None:
    model, path = made(name, fmi)
    assert validate_fmu(str(path)) == []
    q, v = start_of(name, model)
    chosen = ConstrainedMotion(closing(model), independent=[*v], v={f"{c}'": x for c, x in v.items()})
    expected = simulate(model, q, SPAN, kind=chosen, outputs=Outputs(count=6))
    assert expected.is_right
    values = dict(zip(model.coordinates, q, strict=True)) | {f"{c}_d": x for c, x in v.items()}
    for kind in ("CoSimulation", "ModelExchange"):
        found = fmpy.simulate_fmu(
            str(path),
            fmi_type=kind,
            start_values=values,
            start_time=SPAN[0],
            stop_time=SPAN[1],
            output_interval=0.1,
            relative_tolerance=1e-10,
            output=[*model.coordinates, "kinetic_energy"],
        )
        moved = np.array([found[c] for c in model.coordinates]).T
        np.testing.assert_allclose(moved[-1], expected.q[-1], atol=2e-6, err_msg=kind)
        np.testing.assert_allclose(found["kinetic_energy"], expected.series["kinetic_energy"], rtol=1e-5)


@pytest.mark.parametrize("name", TREES)
def test_kinematics_and_outputs_are_those_of_the_interpreter(made: Made, name: str) -> None:
    """der(q) meets the constraints, q'' is its derivative, and outputs are of these."""
    model, path = made(name, "3.0")
    q, v = start_of(name, model)
    values = dict(zip(model.coordinates, q, strict=True)) | {f"{c}_d": x for c, x in v.items()}
    kind = ConstrainedMotion(closing(model), independent=[*v], v={f"{c}'": x for c, x in v.items()})
    motion = simulate(model, q, (0, 1e-4), kind=kind, outputs=Outputs(count=3))
    with instance(path, "ModelExchange", **values) as (one, references):
        read = lambda names: np.array(one.getFloat64([references[x] for x in names]))  # noqa: E731
        rates = read([f"der({c})" for c in model.coordinates])
        second = read([f"{c}_dd" for c in model.coordinates])
        own = read([f"der({c}_d)" for c in v])
        torques = np.array(one.getFloat64([references["inverse_dynamics"]], nValues=model.dof))
    np.testing.assert_allclose(rates, motion.qd[0], atol=1e-12)
    np.testing.assert_allclose(second, (motion.qd[2] - motion.qd[0]) / 1e-4, rtol=1e-2, atol=1e-2)
    np.testing.assert_allclose(own, second[[model.coordinates.index(c) for c in v]], atol=1e-12)
    expected = evaluate(model, "inverse_dynamics", q, rates, qdd=second)["inverse_dynamics"]
    np.testing.assert_allclose(torques, expected, rtol=1e-11, atol=1e-11)


@pytest.mark.parametrize("name", TREES)
def test_directional_derivatives_are_differences(made: Made, name: str) -> None:
    model, path = made(name, "3.0")
    q, v = start_of(name, model)
    values = dict(zip(model.coordinates, q, strict=True)) | {f"{c}_d": x for c, x in v.items()}
    states = [*model.coordinates, *(f"{c}_d" for c in v)]
    unknowns = [f"der({x})" for x in states] + ["kinetic_energy"] + [f"{c}_dd" for c in model.coordinates]
    seed, h = np.random.default_rng(1).uniform(-1, 1, len(states)), 1e-6

    def at(step: float) -> Any:
        moved = {x: values.get(x, 0.0) + step * d for x, d in zip(states, seed, strict=True)}
        with instance(path, "ModelExchange", **moved) as (one, references):
            return np.array(one.getFloat64([references[x] for x in unknowns]))

    with instance(path, "ModelExchange", **values) as (one, references):
        found = one.getDirectionalDerivative(
            [references[x] for x in unknowns], [references[x] for x in states], seed.tolist(), len(unknowns)
        )
    differences = (at(h) - at(-h)) / (2 * h)
    np.testing.assert_allclose(found, differences, rtol=1e-6, atol=1e-6 * np.abs(differences).max())


@pytest.mark.parametrize("name", TREES)
def test_functions_in_c_pass_their_own_test(name: str, tmp_path: Path) -> None:
    """Forward dynamics in independent velocities and q' = T v, beside quantities of the tree."""
    found = package(name, target="c", quantities=("velocity_dynamics", "metric"), name="tied")
    with zipfile.ZipFile(io.BytesIO(found.data)) as files:
        files.extractall(tmp_path)
    text = (tmp_path / "tied.h").read_text()
    arguments = "const double *q, const double *u, const double *x, const double *p"
    assert f"void tied_velocity_dynamics({arguments}" in text
    assert "v.s." in text
    gcc = tool("gcc")
    sources = [str(tmp_path / each) for each in ("tied.c", "tied_selftest.c")]
    subprocess.run([gcc, "-std=c99", *STRICT, *sources, "-o", str(tmp_path / "test"), "-lm"], check=True)
    assert subprocess.run([str(tmp_path / "test")], check=True, capture_output=True, text=True).stdout == "ok\n"


def test_what_the_choice_of_velocities_may_not_be() -> None:
    for given, pointer in (
        ({"target": "fmu", "independent": ("s.z", "s.f")}, "/independent/0"),
        ({"target": "fmu", "independent": ("s.f",)}, "/independent"),
        ({"target": "simulink"}, "/target"),
    ):
        with pytest.raises(InvalidInput) as caught:
            package("sleigh", **given)
        assert caught.value.faults[0].pointer == pointer
