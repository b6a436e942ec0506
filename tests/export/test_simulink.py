"""The S-function compiles against a stand-in for Simulink's header, and its block gives what the interpreter gives."""

from __future__ import annotations

import ctypes
from pathlib import Path

import numpy as np
import pytest
from exported_models import exported_of, tree_of, write
from run_code import arguments, shared, state

from substructures.errors import InvalidArgument
from substructures.export import exported_model, files, interface_of_model
from substructures.expr.interpret import interpret
from substructures.quantities.sources import Sources

STUB = Path(__file__).with_name("simulink")
FLAGS = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", f"-I{STUB}"]
DOUBLES = ctypes.POINTER(ctypes.c_double)


def pointer(x: np.ndarray) -> object:
    return x.ctypes.data_as(DOUBLES)


@pytest.mark.parametrize("parts", [("acrobot",), ("scara", "camera"), ("puma560",)])
def test_the_block_gives_what_the_interpreter_gives(parts: tuple[str, ...], tmp_path: Path) -> None:
    exported = exported_of(tree_of(*parts))
    write(exported, "simulink", tmp_path)
    assert "mex demo_sfun.c demo_simulink.c" in (tmp_path / "demo_build.m").read_text()
    library = shared([tmp_path / "demo_sfun.c", tmp_path / "demo_simulink.c"], FLAGS)
    library.block_start.restype = ctypes.c_char_p
    vectors = exported.interface.vectors
    n = len(vectors["q"])
    values = state(exported.interface)
    q, qd, u, p = (np.array([values[name] for name in vectors[s].names]) for s in ("q", "qd", "u", "p"))
    x = np.concatenate([q, qd])
    assert library.block_start(pointer(p), ctypes.c_size_t(len(p)), pointer(x), ctypes.c_size_t(2 * n)) is None
    rates, outputs = np.zeros(2 * n), np.zeros(65536)
    time = values["t"]
    count = library.block_call(ctypes.c_double(time), pointer(u), pointer(rates), pointer(outputs))
    dynamics = next(f for f in exported.functions if f.quantity == "forward_dynamics")
    accelerations = interpret(dynamics.program, values)["forward_dynamics"]
    np.testing.assert_allclose(rates, [*qd, *accelerations], rtol=1e-12)
    np.testing.assert_array_equal(outputs[: 2 * n], x)
    at = 2 * n
    values |= dict(zip(vectors["qdd"].names, accelerations, strict=True))
    for function in exported.functions:
        if function is not dynamics:
            assert arguments(function, values)
            for y in interpret(function.program, values).values():
                expected = np.ravel(y, order="F")  # as MATLAB has it
                scale = max(1.0, np.abs(expected).max())  # what drives it with its own accelerations is rounding
                np.testing.assert_allclose(outputs[at : at + expected.size], expected, rtol=1e-9, atol=1e-11 * scale)
                at += expected.size
    assert at == count


def test_defaults_and_wrong_lengths(tmp_path: Path) -> None:
    exported = exported_of(tree_of("acrobot"))
    write(exported, "simulink", tmp_path)
    library = shared([tmp_path / "demo_sfun.c", tmp_path / "demo_simulink.c"], FLAGS)
    library.block_start.restype = ctypes.c_char_p
    nothing = ctypes.c_size_t(0)
    assert library.block_start(None, nothing, None, nothing) is None
    p = np.ones(3)
    found = library.block_start(pointer(p), ctypes.c_size_t(3), None, nothing)
    assert found == b"the parameters have the wrong length"
    assert (
        library.block_start(None, nothing, pointer(p), ctypes.c_size_t(3)) == b"the initial state has the wrong length"
    )


def test_what_does_not_move_is_refused() -> None:
    model = tree_of("acrobot")
    exported = exported_model(Sources(model), interface_of_model(model), ["metric"], "demo")
    with pytest.raises(InvalidArgument, match="make a tree of the part"):
        files(exported, "simulink", 10**6)
