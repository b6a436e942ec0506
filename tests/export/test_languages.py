"""Every language whose compiler or interpreter is installed gives what the interpreter of programs gives."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from mixed_program import POINT, mixed_program
from random_expressions import collected, sample
from run_code import STRICT, agree, alone, arguments, by_output, call_c, load_python, octave_call, shared, tool

from substructures.export import files
from substructures.expr.program import Formulas

LIMIT = 100_000
FORMS = pytest.mark.parametrize("form", ["compact", "expanded"])


@FORMS
def test_python(form: str, tmp_path: Path) -> None:
    exported = alone(mixed_program(), "two_links", form)
    (function,) = exported.functions
    module = load_python(files(exported, "python", LIMIT)["two_links.py"].decode(), tmp_path)
    agree(by_output(function, module.two_links_any(**arguments(function, POINT))), function, POINT)
    p = np.array([POINT[name] for name in module.P_NAMES])
    batch = np.stack([p, 2 * p, p / 2])[:, None]
    found = module.two_links_any([], [], [], [], batch)
    assert found["metric"].shape == (3, 1, 2, 2)
    for k, scale in enumerate((1, 2, 0.5)):
        some = {name: scale * x for name, x in POINT.items()}
        agree({name: x[k, 0] for name, x in found.items()}, function, some)
    with pytest.raises(ValueError, match=r"p has the shape \(1,\), \(..., 5\) is needed"):
        module.two_links_any([], [], [], [], [1.0])


@FORMS
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_c(form: str, compiler: str, tmp_path: Path) -> None:
    exported = alone(mixed_program(), form=form)
    for name, data in files(exported, "c", LIMIT).items():
        (tmp_path / name).write_bytes(data)
    library = shared([tmp_path / "model.c"], compiler=tool(compiler))
    (function,) = exported.functions
    agree(call_c(library, exported, function, POINT), function, POINT)


@FORMS
def test_sympy(form: str, tmp_path: Path) -> None:
    exported = alone(mixed_program(), form=form)
    (function,) = exported.functions
    module = load_python(files(exported, "sympy", LIMIT)["model_sympy.py"].decode(), tmp_path)
    assert all(s.is_real for s in module.p)
    values = {s: POINT[s.name] for s in module.p}
    found = {}
    for name, array in module.model_any().items():
        value = array.subs(values)
        found[name] = np.array(value.tolist() if hasattr(value, "tolist") else value, dtype=float)
    agree(found, function, POINT)
    agree(by_output(function, module.model_any(**arguments(function, POINT))), function, POINT)
    with pytest.raises(ValueError, match="q has 1 elements, 0 are needed"):
        module.model_any(q=[1])


@FORMS
def test_matlab(form: str, tmp_path: Path) -> None:
    exported = alone(mixed_program(), form=form)
    (function,) = exported.functions
    for name, data in files(exported, "matlab", LIMIT).items():
        (tmp_path / name).write_bytes(data)
    agree(octave_call(exported, function, POINT, tmp_path), function, POINT)


def test_random_programs(tmp_path: Path) -> None:
    for seed in range(4):
        s = sample(5000 + seed, size=60)
        program = collected(s.graph, f=Formulas((len(s.exprs),), {(i,): e for i, e in enumerate(s.exprs)}))
        exported = alone(program, f"model{seed}")
        (function,) = exported.functions
        module = load_python(files(exported, "python", LIMIT)[f"model{seed}.py"].decode(), tmp_path)
        called = getattr(module, exported.called(function))
        agree(by_output(function, called(**arguments(function, s.point))), function, s.point)
        for name, data in files(exported, "c", LIMIT).items():
            (tmp_path / name).write_bytes(data)
        library = shared([tmp_path / f"model{seed}.c"], STRICT)
        agree(call_c(library, exported, function, s.point), function, s.point)
