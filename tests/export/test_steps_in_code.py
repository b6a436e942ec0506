"""Intermediate values that are quantities of mechanics have their names in code, and no number changes by it."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from exported_models import LIMIT, exported_of, tree_of, write
from made_once import derived_once
from run_code import STRICT, call_c, load_python, shared, state

from substructures import TreeSpec, catalogue
from substructures.export import Exported, files
from substructures.export.stages import staged
from substructures.expr.interpret import interpret
from substructures.printers.meanings import _label
from substructures.tree.glossary import glossary

CASES = (("acrobot",), ("scara", "camera"), ("puma560",))
#: C, and languages with other rules for names
LANGUAGES = (
    "c",
    "cpp",
    "fortran",
    "rust",
    "python",
    "jax",
    "sympy",
    "matlab",
    "julia",
    "modelica",
    "maxima",
    "maple",
    "cuda",
)


def named(*parts: str, **options: bool) -> Exported:
    """All quantities of a tree, with the names of its steps."""
    model = tree_of(*parts)
    instances = [{"name": f"i{k}", "substructure": name} for k, name in enumerate(parts)]
    spec = TreeSpec.read({"name": "demo", "gravity": [0, 0, "-9.81"], "instances": instances})
    made = {f"i{k}": derived_once(catalogue.load(name)) for k, name in enumerate(parts)}
    return exported_of(model, glossary=glossary(spec, made, model=model.program), **options)


def bare(exported: Exported) -> Exported:
    return replace(exported, functions=tuple(replace(each, glossary=None) for each in exported.functions))


@pytest.mark.parametrize("parts", CASES)
def test_names_change_no_bit_in_c(parts: tuple[str, ...], tmp_path: Path) -> None:
    exported = named(*parts, together=True)
    found = []
    for each in (exported, bare(exported)):
        write(each, "c", tmp_path)
        library, values = shared([tmp_path / "demo.c"], STRICT), state(exported.interface)
        found.append([call_c(library, each, function, values) for function in each.functions])
    for first, second in zip(*found, strict=True):
        for name in first:
            np.testing.assert_array_equal(first[name], second[name])


def test_a_name_is_what_it_says(tmp_path: Path) -> None:
    """Every named value of the forward dynamics of two bodies is that of the glossary, at random states."""
    exported = named("acrobot")
    function = next(each for each in exported.functions if each.quantity == "forward_dynamics")
    assert function.glossary is not None
    text = files(replace(exported, functions=(function,)), "python", LIMIT)["demo.py"].decode()
    names = {label.text: label for label in function.steps.values()}
    written = re.sub(r"    return forward_dynamics", "    return locals()", text)
    module = load_python(written, tmp_path)
    values = state(exported.interface)
    given = [values["t"] if s == "t" else [values[n] for n in function.vector(s).names] for s in function.arguments]
    local = module.demo_forward_dynamics(*given)
    absent = dict.fromkeys((s.name for s in function.glossary.symbols), 0.0)
    words = {_label(key): x for key, x in interpret(function.glossary, {**absent, **values}).items()}
    checked = [name for name in names if name in local]
    for name in checked:
        assert float(local[name]) == pytest.approx(float(np.asarray(words[names[name]])), rel=1e-12, abs=1e-12), name
    assert len(checked) >= 7
    assert {"S_1x", "Theta_2yy", "H_21z", "L_21", "y_2"} <= set(checked)


@pytest.mark.parametrize("target", LANGUAGES)
def test_names_stand_in_code_and_in_its_head(target: str) -> None:
    text = "\n".join(data.decode() for data in files(named("acrobot"), target, LIMIT).values())
    assert len(re.findall(r"\bTheta_2yy\b", text)) >= 2
    assert re.search(r"Theta: inertia tensor of what a joint carries", text)


@pytest.mark.parametrize("target", ["reduce", "mathematica", "fricas"])
def test_where_names_have_no_underscore_there_are_none(target: str) -> None:
    assert files(named("acrobot"), target, LIMIT) == files(bare(named("acrobot")), target, LIMIT)


def test_two_stages_have_names_too() -> None:
    text = files(staged(named("scara", "camera")), "c", LIMIT)["demo.c"].decode()
    assert re.search(r"\bm_3\b", text.partition("demo_metric(")[0])
