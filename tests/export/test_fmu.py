"""FMUs: valid by the standard's schemas, simulated by FMPy in both versions and kinds, equal to our own simulations."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from catalogue_entries import shipped_part
from closed_trees import four_bar
from exported_models import tree_of
from run_code import require_clean_sources
from simulated import simulated

from substructures import Model
from substructures.analysis.simulate import FixedStep
from substructures.errors import InvalidArgument, InvalidDocument, MissingValue
from substructures.export import Exported, exported_model, exported_part, files, interface_of_model, interface_of_part
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.sources import Sources

fmpy = pytest.importorskip("fmpy", reason="the wheel FMPy is not installed")
from fmpy.validation import validate_fmu  # noqa: E402

from .fmu_instances import instance  # noqa: E402

QUANTITIES = ("forward_dynamics", "metric", "christoffel", "forces", "kinetic_energy", "potential_energy")
QUANTITIES += ("position", "rotation", "inverse_dynamics")
TARGETS = {"3.0": "fmu", "2.0": "fmu2"}
KINDS = ("ModelExchange", "CoSimulation")
PARTS = {
    "arm": ("acrobot", "camera"),
    "cart": ("cart-pendulum",),
    "robot": ("scara", "parallel-gripper"),
    "puma": ("puma560",),
}


def exported_of(model: Model, packed: bool = True) -> Exported:
    interface = interface_of_model(model, 'demo@1 <&"', "sha256:1")
    return exported_model(Sources(model), interface, QUANTITIES, "demo", packed=packed)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> dict[tuple[str, str], tuple[Model, Path]]:
    folder, found = tmp_path_factory.mktemp("fmu"), {}
    for name, parts in PARTS.items():
        model = tree_of(*parts)
        for version, target in TARGETS.items():
            path = folder / f"{name}{version[0]}.fmu"
            path.write_bytes(files(exported_of(model), target, 10**6)["demo.fmu"])
            found[name, version] = model, path
    return found


def starts(model: Model) -> dict[str, float]:
    q = {name: 0.3 + 0.1 * i for i, name in enumerate(model.coordinates)}
    return q | {f"{name}_d": 0.2 - 0.1 * i for i, name in enumerate(model.coordinates)}


@pytest.mark.parametrize("version", TARGETS)
@pytest.mark.parametrize("name", PARTS)
def test_the_standard_finds_nothing(made: Any, name: str, version: str) -> None:
    assert validate_fmu(str(made[name, version][1])) == []


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("version", TARGETS)
@pytest.mark.parametrize("name", PARTS)
def test_simulated_it_moves_as_here(made: Any, name: str, version: str, kind: str) -> None:
    """To 1e-8 of the largest coordinate, as by our own simulation with DOP853 at 1e-12."""
    model, path = made[name, version]
    start, n = starts(model), model.dof
    found = fmpy.simulate_fmu(
        str(path), fmi_type=kind, start_values=start, stop_time=0.5, output_interval=0.1, relative_tolerance=1e-12,
        output=list(start),
    )  # fmt: skip
    fine = {"relative_tolerance": 1e-12, "absolute_tolerance": 1e-12, "method": "DOP853"}
    values = list(start.values())
    ours = simulated(model, q=values[:n], qd=values[n:], span=(0, 0.5), times=found["time"], **fine)
    expected = np.hstack([ours.q, ours.qd])
    shown = np.stack([found[each] for each in start], axis=1)
    assert np.abs(shown - expected).max() <= 1e-8 * np.abs(expected).max()


@pytest.mark.parametrize("name", PARTS)
def test_outputs_are_those_of_the_interpreter(made: Any, name: str) -> None:
    model, path = made[name, "3.0"]
    start, n = starts(model), model.dof
    wanted = ["forward_dynamics", "metric", "forces", "kinematics"]
    state = {"q": list(start.values())[:n], "qd": list(start.values())[n:]}
    expected = evaluate(model, wanted, **state)
    with instance(path, **start) as (one, at):
        metric = np.array(one.getFloat64([at["metric"]], nValues=n * (n + 1) // 2))
        np.testing.assert_allclose(metric, expected["metric"][np.tril_indices(n)], rtol=1e-12, atol=1e-15)
        rates = np.array(one.getFloat64([at[f"der({c}_d)"] for c in model.coordinates]))
        np.testing.assert_allclose(rates, expected["forward_dynamics"], rtol=1e-10)
        for k, frame in enumerate(model.frames):
            found = np.array(one.getFloat64([at[f"{frame}.rotation"]], nValues=9)).reshape(3, 3)
            np.testing.assert_allclose(found, expected["kinematics"]["rotation"][k], rtol=0, atol=1e-14)
        # Newton's law: with its own accelerations nothing has to drive it
        needed = np.array(one.getFloat64([at["inverse_dynamics"]], nValues=n))
        assert np.abs(needed).max() <= 1e-9 * max(1.0, np.abs(expected["forces"]).max())


@pytest.mark.parametrize("name", PARTS)
def test_directional_derivatives_are_differences(made: Any, name: str) -> None:
    model, path = made[name, "3.0"]
    n, rng = model.dof, np.random.default_rng(7)
    start = starts(model)
    by = [*start, *(f"tau.{c}" for c in model.coordinates)]
    sizes = {"metric": n * (n + 1) // 2, "kinetic_energy": 1, "forces": n, "inverse_dynamics": n}
    with instance(path, "ModelExchange", **start) as (one, at):
        rates = [f"der({c}_d)" for c in model.coordinates]
        places = [at[r] for r in rates] + [at[o] for o in sizes]
        count = n + sum(sizes.values())
        seed = rng.uniform(-1, 1, len(by))
        found = np.array(one.getDirectionalDerivative(places, [at[b] for b in by], list(seed), count))
        begin = np.array([*start.values(), *[0.0] * n])
        values = []
        for h in (1e-5, -1e-5):
            one.setFloat64([at[b] for b in by], list(begin + h * seed))
            values.append(np.array(one.getFloat64(places, nValues=count)))
        expected = (values[0] - values[1]) / 2e-5
        assert np.abs(found - expected).max() <= 1e-6 * np.abs(expected).max()


def test_states_are_kept_and_written(made: Any) -> None:
    model, path = made["arm", "3.0"]
    states = [made["arm", "3.0"][0].coordinates[0], f"{model.coordinates[1]}_d"]
    with instance(path, **starts(model)) as (one, at):
        one.doStep(0.0, 0.5)
        kept = one.getFMUState()
        written = one.serializeFMUState(kept)
        one.doStep(0.5, 0.5)
        first = one.getFloat64([at[s] for s in states])
        for each in (kept, one.deserializeFMUState(written)):
            one.setFMUState(each)
            one.doStep(0.5, 0.5)
            assert one.getFloat64([at[s] for s in states]) == first
        one.freeFMUState(kept)
        with pytest.raises(Exception, match="fmi3DeserializeFMUState"):
            one.deserializeFMUState(b"\0" * len(written))


def test_inputs_and_parameters_are_those_of_the_tree(made: Any) -> None:
    model, path = made["cart", "2.0"]
    start = starts(model)
    name, mass = model.coordinates[0], next(p for p in model.parameters if p.endswith(".m1") or ".m" in p)
    push, heavy = {f"tau.{name}": 1.5}, {mass: 2.5}
    found = fmpy.simulate_fmu(
        str(path), fmi_type="CoSimulation", start_values={**start, **push, **heavy}, stop_time=1.0,
        relative_tolerance=1e-12, output=list(start),
    )  # fmt: skip
    n, values = model.dof, list(start.values())
    fine = {"relative_tolerance": 1e-12, "absolute_tolerance": 1e-12, "method": "DOP853"}
    ours = simulated(
        model, q=values[:n], qd=values[n:], span=(0, 1), inputs=push, parameters=heavy, times=[0, 1], **fine
    )
    shown = [found[each][-1] for each in start]
    np.testing.assert_allclose(shown, [*ours.q[-1], *ours.qd[-1]], rtol=1e-8, atol=1e-8)


def test_fixed_steps_are_of_order_four(made: Any) -> None:
    model, path = made["arm", "3.0"]
    start = starts(model)
    ends = []
    for step in (0.02, 0.01, 0.0):
        with instance(path, **start, solver_step=step, solver_tolerance=1e-13) as (one, at):
            for k in range(4):
                one.doStep(0.1 * k, 0.1)
            ends.append(np.array(one.getFloat64([at[name] for name in start])))
    errors = [np.abs(each - ends[2]).max() for each in ends[:2]]
    assert 10 < errors[0] / errors[1] < 24
    fixed = FixedStep(0.01, "rk4")
    values = list(start.values())
    ours = simulated(model, q=values[:2], qd=values[2:], span=(0, 0.4), times=[0, 0.4], fixed_step=fixed)
    np.testing.assert_allclose(ends[1], [*ours.q[-1], *ours.qd[-1]], rtol=1e-11)


def test_what_cannot_be_is_refused_by_the_instance(made: Any) -> None:
    model, path = made["arm", "3.0"]
    with instance(path, **starts(model)) as (one, at):
        for name in ("metric", f"der({model.coordinates[0]})", "kinetic_energy"):
            with pytest.raises(Exception, match="fmi3SetFloat64"):
                one.setFloat64([at[name]], [1.0])
        with pytest.raises(Exception, match="fmi3GetFloat64"):
            one.getFloat64([at["metric"] + 1])
        with pytest.raises(Exception, match="fmi3GetInt32"):
            one.getInt32([at["metric"]])
        one.setFloat64([at[model.coordinates[0]]], [float("nan")])
        with pytest.raises(Exception, match="fmi3DoStep"):
            one.doStep(0.0, 0.1)
    description = fmpy.read_model_description(str(path))
    wrong = fmpy.fmi3.FMU3Slave(guid="{other}", unzipDirectory=fmpy.extract(str(path)), modelIdentifier="demo")
    with pytest.raises(Exception, match=r"[Ii]nstantiate"):
        wrong.instantiate()
    assert description.guid != "{other}"


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("version", TARGETS)
def test_the_sources_compile_without_a_warning(made: Any, version: str, compiler: str, tmp_path: Path) -> None:
    require_clean_sources(made["robot", version][1], compiler, tmp_path)


def test_the_same_request_gives_the_same_bytes() -> None:
    exported = exported_of(tree_of("acrobot"))
    assert files(exported, "fmu", 10**6) == files(exported, "fmu", 10**6)
    other = files(exported_of(tree_of("acrobot"), packed=False), "fmu", 10**6)["demo.fmu"]
    tokens = set()
    for data in (other, files(exported, "fmu", 10**6)["demo.fmu"]):
        text = zipfile.ZipFile(io.BytesIO(data)).read("modelDescription.xml").decode()
        tokens.add(text.partition('instantiationToken="')[2].partition('"')[0])
    assert len(tokens) == 2


def test_what_is_no_tree_that_moves_is_refused() -> None:
    model = tree_of("acrobot")
    part = exported_part(*_part("acrobot"), ["metric"], "demo")
    with pytest.raises(InvalidArgument, match="make a tree of the part"):
        files(part, "fmu", 10**6)
    without = exported_model(Sources(model), interface_of_model(model), ["metric"], "demo")
    with pytest.raises(InvalidArgument, match="needs the accelerations"):
        files(without, "fmu", 10**6)
    closed = four_bar((0, 0, -9.81))
    with pytest.raises(InvalidDocument, match="clos"):
        exported_model(Sources(closed), interface_of_model(closed), ["forward_dynamics"], "demo")


def test_a_parameter_without_value_is_named() -> None:
    model = tree_of("acrobot")
    free = interface_of_model(model)
    p = free.vectors["p"]
    nothing = type(p)("p", p.names, p.units, (float("nan"), *p.defaults[1:]))
    interface = type(free)({**free.vectors, "p": nothing})
    exported = exported_model(Sources(model), interface, ["forward_dynamics"], "demo")
    with pytest.raises(MissingValue, match=f"^'{p.names[0]}' has no value") as caught:
        files(exported, "fmu", 10**6)
    assert caught.value.name == p.names[0]


def _part(name: str) -> Any:
    part = shipped_part(name)
    return part, interface_of_part(part)


def test_without_a_compiler_there_are_sources(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("shutil.which", lambda _: None)
    monkeypatch.setattr("substructures.export.fmu.binaries.find_spec", lambda _: None)
    names = zipfile.ZipFile(io.BytesIO(files(exported_of(tree_of("acrobot")), "fmu", 10**6)["demo.fmu"])).namelist()
    assert "sources/buildDescription.xml" in names
    assert not [name for name in names if name.startswith("binaries/")]
