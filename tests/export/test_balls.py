"""Trees with ball and floating joints in C and Python: q has places and quaternions, qd the rates."""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from exported_models import LIMIT, write
from mechanics.reduced_parts import on_a_hull
from run_code import STRICT, agree, by_output, call_c, load_python, shared, state
from simulated import simulated

from substructures import Model, couple, derive
from substructures.errors import InvalidArgument
from substructures.export import Exported, exported_model, files, interface_of_model
from substructures.expr.interpret import interpret
from substructures.quantities.sources import Sources

fmpy = pytest.importorskip("fmpy", reason="the wheel FMPy is not installed")
from fmpy.validation import validate_fmu  # noqa: E402

from .fmu_instances import instance  # noqa: E402

STUB = Path(__file__).with_name("simulink")
QUANTITIES = (
    "forward_dynamics",
    "metric",
    "christoffel",
    "forces",
    "bias",
    "kinetic_energy",
    "potential_energy",
    "position_rates",
    "position",
)


@pytest.fixture(scope="module")
def model() -> Model:
    inertia = {"xx": 1, "yy": 2, "zz": 3}
    hull: dict[str, Any] = {
        "name": "hull",
        "parent": "base",
        "mass": 2,
        "inertia": inertia,
        "joint": {"type": "floating"},
    }
    arm = {"name": "arm", "parent": "hull", "mass": 1, "com": [1, 0, 0], "inertia": inertia, "joint": {"type": "ball"}}
    wheel = {**arm, "name": "wheel", "parent": "arm", "joint": {"type": "revolute", "coordinate": "q", "d": 1}}
    tree = {"name": "t", "gravity": [0, 0, "-9.81"], "instances": [{"name": "x", "substructure": "sat"}]}
    return couple(tree, {"x": derive({"name": "sat", "bodies": [hull, arm, wheel]})})


def exported_of(model: Model) -> Exported:
    return exported_model(Sources(model), interface_of_model(model, "demo@1", "sha256:1"), QUANTITIES, "demo")


def test_functions_are_those_of_the_interpreter(model: Model, tmp_path: Path) -> None:
    exported = exported_of(model)
    assert [len(exported.interface.vectors[symbol]) for symbol in ("q", "qd", "qdd")] == [12, 10, 10]
    values = state(exported.interface)
    write(exported, "c", tmp_path)
    library = shared([tmp_path / "demo.c"])
    text = next(x for name, x in files(exported, "python", LIMIT).items() if name.endswith(".py"))
    module = load_python(text.decode() if isinstance(text, bytes) else text, tmp_path)
    for function in exported.functions:
        agree(call_c(library, exported, function, values), function, values)
        given = [[values[name] for name in function.vector(symbol).names] for symbol in function.arguments]
        called = getattr(module, exported.called(function))
        agree(by_output(function, called(*map(np.array, given))), function, values)


@pytest.fixture(scope="module")
def made(model: Model, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder, found = tmp_path_factory.mktemp("fmu"), {}
    for target in ("fmu", "fmu2"):
        found[target] = folder / f"{target}.fmu"
        found[target].write_bytes(files(exported_of(model), target, 10**6)["demo.fmu"])
    return found


def starts(model: Model) -> dict[str, float]:
    """Turned about oblique axes, and with a spin; by the names of variables of FMUs."""
    q = dict(zip(model.positions, [0.1, 0.2, 0.3, 0.5, 0.5, -0.5, 0.5, 0.6, 0, 0.8, 0, 0.4], strict=True))
    rates = [name if name not in model.positions else f"{name}_d" for name in model.coordinates]
    return q | {name: 1.2 - 0.3 * i for i, name in enumerate(rates)}


@pytest.mark.parametrize("kind", ["ModelExchange", "CoSimulation"])
@pytest.mark.parametrize("target", ["fmu", "fmu2"])
def test_an_fmu_moves_as_here(model: Model, made: dict[str, Path], target: str, kind: str) -> None:
    assert validate_fmu(str(made[target])) == []
    start, m = starts(model), len(model.positions)
    found = fmpy.simulate_fmu(
        str(made[target]), fmi_type=kind, start_values=start, stop_time=1, output_interval=0.2, output=list(start),
        relative_tolerance=1e-12,
    )  # fmt: skip
    values, fine = list(start.values()), {"relative_tolerance": 1e-12, "absolute_tolerance": 1e-12, "method": "DOP853"}
    ours = simulated(model, q=values[:m], qd=values[m:], span=(0, 1), times=found["time"], **fine)
    assert np.abs(np.diff(ours.q, axis=0)).max() > 0.1
    shown = np.stack([found[name] for name in start], axis=1)
    np.testing.assert_allclose(shown, np.hstack([ours.q, ours.qd]), rtol=0, atol=1e-8)
    if kind == "CoSimulation":
        np.testing.assert_allclose(np.linalg.norm(shown[:, 3:7], axis=1), 1, atol=1e-15)


def test_an_fmu_of_a_linkage_on_a_floating_base_moves_as_here(tmp_path: Path) -> None:
    """On the reduced level: the states are those of the base and of the crank."""
    model = on_a_hull("crank-rocker", {"type": "floating"}, is_handed=False)
    (tmp_path / "demo.fmu").write_bytes(files(exported_of(model), "fmu", 10**6)["demo.fmu"])
    rates = [name if name not in model.positions else f"{name}_d" for name in model.coordinates]
    q, qd = [0.1, 0.2, 0.3, 0.5, 0.5, -0.5, 0.5, 1.0], [0.1, 0, 0.2, 0.5, -1, 0.7, 3]
    start = dict(zip([*model.positions, *rates], [*q, *qd], strict=True))
    found = fmpy.simulate_fmu(
        str(tmp_path / "demo.fmu"), fmi_type="ModelExchange", start_values=start, stop_time=0.4, output_interval=0.2,
        output=list(start), relative_tolerance=1e-12,
    )  # fmt: skip
    fine = {"relative_tolerance": 1e-12, "absolute_tolerance": 1e-12, "method": "DOP853"}
    ours = simulated(model, q=q, qd=qd, span=(0, 0.4), times=found["time"], **fine)
    shown = np.stack([found[name] for name in start], axis=1)
    np.testing.assert_allclose(shown, np.hstack([ours.q, ours.qd]), rtol=0, atol=1e-8)


def test_an_fmu_says_what_its_states_are(made: dict[str, Path]) -> None:
    told = {each.name: each for each in fmpy.read_model_description(str(made["fmu"])).modelVariables}
    assert [told[f"x.q_hull_{axis}"].start for axis in "wxyz"] == ["1.0", "0.0", "0.0", "0.0"]
    units = {"x.r_hull_x": "m", "x.q_hull_w": None, "x.v_hull_x": "m/s", "x.w_hull_x": "rad/s", "x.q_d": "rad/s"}
    units |= {"der(x.q_hull_w)": "1/s", "der(x.r_hull_x)": "m/s", "der(x.w_hull_x)": "rad/s^2", "der(x.q)": "rad/s"}
    assert {name: told[name].unit for name in units} == units
    assert "position_rates" not in told


def test_directional_derivatives_are_differences(model: Model, made: dict[str, Path]) -> None:
    start, rng = starts(model), np.random.default_rng(3)
    by = [*start, *(f"tau.{name}" for name in model.coordinates)]
    with instance(made["fmu"], "ModelExchange", **start) as (one, at):
        places = [*(at[f"der({name})"] for name in start), at["kinetic_energy"]]
        seed = rng.uniform(-1, 1, len(by))
        found = np.array(one.getDirectionalDerivative(places, [at[name] for name in by], list(seed), len(places)))
        begin, values = np.array([*start.values(), *[0.0] * model.dof]), []
        for h in (1e-5, -1e-5):
            one.setFloat64([at[name] for name in by], list(begin + h * seed))
            values.append(np.array(one.getFloat64(places)))
    expected = (values[0] - values[1]) / 2e-5
    np.testing.assert_allclose(found, expected, atol=1e-6 * np.abs(expected).max())


def test_a_block_for_simulink(model: Model, tmp_path: Path) -> None:
    """Of 12 numbers and 10 rates; by itself it begins with quaternions that turn nothing."""
    exported = exported_of(model)
    write(exported, "simulink", tmp_path)
    library = shared([tmp_path / "demo_sfun.c", tmp_path / "demo_simulink.c"], [*STRICT, f"-I{STUB}"])
    library.block_start.restype = ctypes.c_char_p
    values, nothing = state(exported.interface), ctypes.c_size_t(0)
    vectors = exported.interface.vectors
    q, qd, u = (np.array([values[name] for name in vectors[symbol].names]) for symbol in ("q", "qd", "u"))
    x, rates, outputs = np.concatenate([q, qd]), np.zeros(22), np.zeros(65536)
    assert library.block_start(None, nothing, x.ctypes, ctypes.c_size_t(22)) is None
    library.block_call(ctypes.c_double(0), u.ctypes, rates.ctypes, outputs.ctypes)
    found = {each.quantity: interpret(each.program, values) for each in exported.functions}
    moved, second = (found[name][name] for name in ("position_rates", "forward_dynamics"))
    np.testing.assert_allclose(rates, [*moved, *second], rtol=1e-12)
    np.testing.assert_array_equal(outputs[:22], x)
    np.testing.assert_allclose(outputs[22:122].reshape(10, 10), found["metric"]["metric"], rtol=1e-12, atol=1e-15)
    assert library.block_start(None, nothing, None, nothing) is None
    library.block_call(ctypes.c_double(0), u.ctypes, rates.ctypes, outputs.ctypes)
    np.testing.assert_array_equal(outputs[:22], [0, 0, 0, 1, 0, 0, 0, 1, *[0] * 14])


def test_what_cannot_be_is_refused(model: Model) -> None:
    interface = interface_of_model(model, "demo@1", "sha256:1")
    for target in ("fmu", "simulink"):
        with pytest.raises(InvalidArgument, match="position_rates"):
            files(exported_model(Sources(model), interface, ("forward_dynamics",), "demo"), target, LIMIT)
