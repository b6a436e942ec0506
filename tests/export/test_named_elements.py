"""Elements of arguments have names of their own, which stay whatever stands beside them."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from catalogue_entries import shipped_part
from exported_models import LIMIT, exported_of, tree_of, write
from run_code import load_python, octave

from substructures import couple, evaluate
from substructures.export import Exported, exported_model, files, interface_of_model
from substructures.quantities.sources import Sources

CONSTANTS = ("c", "cpp", "rust", "fortran", "julia", "modelica", "maxima", "maple", "reduce", "fricas", "mathematica")


def crane(**parameters: float) -> Exported:
    """A tree with parameters of its own."""
    given = {name: {"value": value, "unit": "m"} for name, value in parameters.items()}
    tree = {
        "name": "crane",
        "gravity": [0, 0, "-g"],
        "parameters": {"g": {"value": 9.81, "unit": "m/s^2"}, **given},
        "instances": [{"name": "load", "substructure": "simple-pendulum"}],
    }
    model = couple(tree, {"load": shipped_part("simple-pendulum")})
    return exported_model(Sources(model), interface_of_model(model), ["metric", "forces"], "crane")


def constants(exported: Exported, target: str) -> set[str]:
    """The names of places in a file."""
    text = next(iter(files(exported, target, LIMIT).values())).decode()
    text = text.replace("!_", "_")
    return set(re.findall(r"\b((?:crane_|crane)?[PQU]_?\w+)(?:: usize|:)?\s*(?:=|:=|:)\s*\d+", text))


@pytest.mark.parametrize("target", CONSTANTS)
def test_another_parameter_changes_no_name(target: str) -> None:
    few, more = constants(crane(), target), constants(crane(a0=1.0, load_x=2.0), target)
    assert few < more
    assert any("oad" in name.lower() for name in few)


def test_two_that_would_have_one_name_have_none() -> None:
    """Code that used it does not compile, rather than mean another."""
    before, after = constants(crane(), "c"), constants(crane(load_m=2.0), "c")
    assert "crane_P_load_m" in before
    assert "crane_P_load_m" not in after


def test_words_of_a_language_and_odd_names_in_structures(tmp_path: Path) -> None:
    exported = crane(**{"lambda": 2.0, "end": 3.0, "L": 1.0, "l": 4.0})
    module = load_python(files(exported, "python", LIMIT)["crane.py"].decode(), tmp_path)
    assert module.Parameters()._asdict()["lambda_"] == 2.0
    assert list(module.Parameters()) == list(exported.interface.vectors["p"].defaults)
    write(exported, "matlab", tmp_path)
    found = octave("s = crane_parameters(); printf('%.17g ', s.end_, crane_parameters(s));", tmp_path)[0].split()
    assert [float(x) for x in found] == [3.0, *exported.interface.vectors["p"].defaults]


def test_structures_are_arguments(tmp_path: Path) -> None:
    model, exported = tree_of("acrobot"), exported_of(tree_of("acrobot"))
    heavy = {"i0.m2": 2.0}
    expected = evaluate(model, "metric", q=[0.1, 0.4], parameters=heavy)["metric"]
    module = load_python(files(exported, "python", LIMIT)["demo.py"].decode(), tmp_path)
    q = module.Coordinates(i0_q1=0.1, i0_q2=0.4)
    np.testing.assert_allclose(module.demo_metric(q, module.P._replace(i0_m2=2.0)), expected, rtol=1e-14)
    write(exported, "matlab", tmp_path)
    script = (
        "q = demo_coordinates(); q.i0_q1 = 0.1; q.i0_q2 = 0.4; p = demo_parameters(); p.i0_m2 = 2;"
        "printf('%.17g ', demo_metric(demo_coordinates(q), demo_parameters(p)));"
    )
    found = np.array(octave(script, tmp_path)[0].split(), dtype=float).reshape(2, 2)
    np.testing.assert_allclose(found, expected, rtol=1e-14)
    typo = "p = demo_parameters(); p.i0_M2 = 2; try, demo_parameters(p); catch e, disp(e.message); end"
    assert octave(typo, tmp_path)[0] == "i0_M2 is none of the parameters"


def test_a_mechanism_of_modelica_has_parameters_with_units() -> None:
    text = files(crane(), "modelica", LIMIT)["crane.mo"].decode()
    assert 'parameter Real load_m(unit="kg") = ' not in text  # no inverse dynamics, no model
    text = files(exported_of(tree_of("acrobot")), "modelica", LIMIT)["demo.mo"].decode()
    assert 'parameter Real i0_l1(unit="m") = 1.0 "i0.l1";' in text
    assert 'parameter Real i0_Ic1(unit="kg.m2") = 0.083 "i0.Ic1";' in text
