"""CUDA: the file is compiled by NVRTC where that is installed, and its logic is run by g++ from the same source."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path

import pytest
from catalogue_entries import shipped_part
from mixed_program import POINT, mixed_program
from run_code import agree, alone, state

from substructures import Model, TreeSpec, couple
from substructures.export import Exported, exported_model, files, interface_of_model
from substructures.export.languages import cuda
from substructures.quantities.sources import Sources

from .cuda_on_cpu import LIMIT, call, library

QUANTITIES = ("metric", "christoffel", "forces", "inverse_dynamics", "forward_dynamics")


def model() -> Model:
    """A robot with a wrist of its own on its flange."""
    instances = [
        {"name": "a", "substructure": "ur5"},
        {"name": "b", "substructure": "spherical-wrist", "at": "a.flange"},
    ]
    parts = {"a": "ur5", "b": "spherical-wrist"}
    spec = TreeSpec.read({"name": "t", "gravity": [0, 0, "-9.81"], "instances": instances})
    return couple(spec, {k: shipped_part(v) for k, v in parts.items()})


@pytest.fixture(scope="module")
def robot() -> Exported:
    found = model()
    return exported_model(Sources(found), interface_of_model(found), QUANTITIES, "robot")


@pytest.mark.parametrize("common", [False, True])
@pytest.mark.parametrize("length", [1, 5, 600])
def test_every_operation(length: int, common: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cuda, "LENGTH", length)
    exported = alone(mixed_program())
    (function,) = exported.functions
    scales = (1.0, 1.0, 1.0) if common else (1.0, 2.0, 0.5)
    states: list[Mapping[str, float]] = [{n: scale * x for n, x in POINT.items()} for scale in scales]
    found = call(library(exported, tmp_path), exported, function, states, common)
    for one, values in zip(found, states, strict=True):
        agree(one, function, values)


@pytest.mark.parametrize("common", [False, True])
def test_states_of_a_robot(robot: Exported, common: bool, tmp_path: Path) -> None:
    loaded = library(robot, tmp_path)
    states = [state(robot.interface, seed) for seed in range(5)]
    if common:
        shared_values = {n: states[0][n] for n in robot.interface.vectors["p"].names}
        states = [values | shared_values for values in states]
    else:
        states = [
            values | {n: values[n] * (1 + seed / 10) for n in robot.interface.vectors["p"].names}
            for seed, values in enumerate(states)
        ]
    for function in robot.functions:
        for one, values in zip(call(loaded, robot, function, states, common), states, strict=True):
            agree(one, function, values, 1e-11)


def test_nvrtc_compiles_it(robot: Exported) -> None:
    if find_spec("nvidia") is None or not (path := nvrtc()):
        pytest.skip("the wheel nvidia-cuda-nvrtc is not installed")
    for exported in (robot, alone(mixed_program())):
        text = files(exported, "cuda", LIMIT)[f"{exported.name}.cu"]
        compiled = ptx(ctypes.CDLL(path), text)
        for function in exported.functions:
            assert f".visible .entry {exported.called(function)}_states(" in compiled


def nvrtc() -> str:
    """The library of the wheel."""
    spec = find_spec("nvidia")
    folders = [Path(p) for p in (spec.submodule_search_locations or ())] if spec else []
    found = [
        str(path) for folder in folders for path in sorted(folder.glob("**/libnvrtc.so.*")) if "alt" not in path.name
    ]
    return found[0] if found else ""


def ptx(compiler: ctypes.CDLL, source: bytes) -> str:
    """PTX for the oldest GPUs that the compiler knows."""
    program, size = ctypes.c_void_p(), ctypes.c_size_t()
    assert compiler.nvrtcCreateProgram(ctypes.byref(program), source, b"model.cu", 0, None, None) == 0
    code = compiler.nvrtcCompileProgram(program, 0, None)
    compiler.nvrtcGetProgramLogSize(program, ctypes.byref(size))
    log = ctypes.create_string_buffer(size.value)
    compiler.nvrtcGetProgramLog(program, log)
    assert code == 0, log.value.decode()
    assert "warning" not in log.value.decode(), log.value.decode()
    compiler.nvrtcGetPTXSize(program, ctypes.byref(size))
    text = ctypes.create_string_buffer(size.value)
    compiler.nvrtcGetPTX(program, text)
    return text.value.decode()
