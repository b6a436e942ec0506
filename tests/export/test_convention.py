"""The calling convention: a wrong order is impossible, several files link, wrong lengths are refused."""

from __future__ import annotations

import ctypes
import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
from catalogue_entries import all_entries, open_entry, shipped_part
from exported_models import LIMIT, derived_anew, exported_of, tree_of, write
from made_once import coupled_once
from run_code import STRICT, agree, by_output, call_c, load_python, octave, octave_call, shared, state, tool

from substructures import Model, evaluate
from substructures.errors import InvalidArgument
from substructures.export import TARGETS, exported_model, files, interface_of_model, interface_of_part, render
from substructures.expr.bind import bind
from substructures.expr.program import Program
from substructures.part.outputs import with_own_inertia
from substructures.quantities.sources import Sources

#: the contract, section 8, of what has no time
CONTRACT = {
    **dict.fromkeys(("metric", "christoffel", "gravity", "kinematics", "momentum"), "q p"),
    "potential_energy": "q p",
    **dict.fromkeys(("coriolis", "bias", "kinetic_energy", "total_momentum"), "q qd p"),
    "forces": "q qd u p",
    "inverse_dynamics": "q qd qdd u p",
    "forward_dynamics": "q qd u p",
}


def with_defaults(program: Program, model: Model) -> Program:
    given = {n: p["value"] for n, p in model.parameters.items()}
    return bind(program, {n: x for n, x in given.items() if n in program.needs(program.outputs)})


@pytest.fixture(scope="module")
def acrobot() -> Model:
    return tree_of("acrobot")


def test_signatures_are_those_of_the_contract(acrobot: Model) -> None:
    exported = exported_of(acrobot)
    assert {f.quantity: " ".join(f.arguments) for f in exported.functions} == CONTRACT
    left = interface_of_model(acrobot).bound(acrobot.parameters)
    bound = [
        render(with_defaults(f.program, acrobot), "c", interface=left, quantity=f.quantity) for f in exported.functions
    ]
    for f, text in zip(exported.functions, bound, strict=True):
        assert f"model_{f.quantity}({', '.join(f.arguments)})" in text


def test_there_is_a_time_where_something_depends_on_it() -> None:
    """Whether or not that which does occurs in a formula: forces of a part that rocks, not the metric."""
    load = {"name": "rock", "type": "torque", "to": "i0.link1", "vector": [0, 0, "M*sin(t)"]}
    one = {"name": "i0", "substructure": "acrobot"}
    tree = {"name": "demo", "gravity": [0, 0, "-9.81"], "instances": [one], "parameters": {"M": {"unit": "N*m"}}}
    exported = exported_of(coupled_once({**tree, "loads": [load]}, {"acrobot": open_entry("acrobot")}))
    found = {f.quantity: " ".join(f.arguments) for f in exported.functions}
    timed = {"potential_energy", "forces", "inverse_dynamics", "forward_dynamics"}
    assert found == {name: f"t {given}" if name in timed else given for name, given in CONTRACT.items()}


@pytest.mark.parametrize("name", all_entries())
def test_signatures_cover_every_shipped_part(name: str) -> None:
    model = tree_of(name)
    if model.dof:
        exported_of(model)


def test_the_metric_with_numbers_bound_is_not_of_another_coordinate(acrobot: Model, tmp_path: Path) -> None:
    """It depends on q2 alone, and was called with x = [q2]: with x = [q1; q2] it took q1 for q2."""
    q = [1.2, 0.3]
    bound = with_defaults(acrobot.program.select(["metric"]), acrobot)
    interface = interface_of_model(acrobot).bound(acrobot.parameters)
    text = render(bound, "matlab", name="acrobot", interface=interface, quantity="metric")
    (tmp_path / "acrobot_metric.m").write_text(text)
    script = "printf('%.17g ', acrobot_metric([1.2; 0.3], []), acrobot_metric([1.2 0.3]));"
    found = np.array(octave(script, tmp_path)[0].split(), dtype=float).reshape(2, 2, 2)
    expected = evaluate(acrobot, "metric", q=q)["metric"]
    np.testing.assert_allclose(found[0], expected, rtol=1e-14)
    np.testing.assert_allclose(found[1], expected, rtol=1e-14)
    # closed form of the textbook's metric: I1 + I2 + m1 lc1^2 + m2 (l1^2 + lc2^2 + 2 l1 lc2 cos q2)
    assert found[0, 0, 0] == pytest.approx(0.083 + 0.33 + 0.25 + (1 + 0.25 + np.cos(0.3)), rel=1e-14)
    assert found[0, 0, 0] == pytest.approx(2.8683, abs=5e-5)


@pytest.mark.parametrize("call", ["[1; 2; 3], p", "1, p", "[1; 2], [p; 1]", "[1; 2], p(2:end)", "[], p"])
def test_wrong_lengths_are_refused_in_octave(acrobot: Model, call: str, tmp_path: Path) -> None:
    write(exported_of(acrobot), "matlab", tmp_path)
    script = f"p = ones(8, 1); try, demo_metric({call}); disp('none'), catch e, disp(e.identifier), end"
    assert octave(script, tmp_path)[0].strip() == "demo_metric:length"


def test_wrong_lengths_are_refused_in_python(acrobot: Model, tmp_path: Path) -> None:
    module = load_python(write(exported_of(acrobot), "python", tmp_path)[0].read_text(), tmp_path)
    for arguments in (([1, 2, 3],), ([1],), ([1, 2], [1.0] * 7), (0.5,)):
        with pytest.raises(ValueError, match="is needed"):
            module.demo_metric(*arguments)


def test_files_of_several_quantities_and_trees_link(acrobot: Model, tmp_path: Path) -> None:
    other = tree_of("cart-pendulum")
    sources = []
    for model, name in ((acrobot, "one"), (other, "two")):
        sources += [p for p in write(exported_of(model, name), "c", tmp_path) if p.name == f"{name}.c"]
    interface = interface_of_model(acrobot)
    for quantity in ("metric", "forces"):  # as format=c serves them
        text = render(acrobot.program.select([quantity]), "c", name=f"just_{quantity}", interface=interface)
        (tmp_path / f"{quantity}.c").write_text(text)
        sources.append(tmp_path / f"{quantity}.c")
    library = shared(sources)
    for model, name in ((acrobot, "one"), (other, "two")):
        exported = exported_of(model, name)
        values = state(exported.interface)
        for function in exported.functions:
            agree(call_c(library, exported, function, values), function, values)


def test_the_header_can_be_used_from_cpp(acrobot: Model, tmp_path: Path) -> None:
    write(exported_of(acrobot), "c", tmp_path)
    (tmp_path / "main.cpp").write_text(
        '#include "demo.h"\n#include <cstdio>\nint main() { double p[demo_NP], q[demo_NQ] = {1.2, 0.4}, m[4];\n'
        'demo_defaults(p); q[demo_Q_i0_q1] = 0.1; demo_metric(q, p, m); std::printf("%.17g", m[0]); }\n'
    )
    subprocess.run([tool("gcc"), *STRICT, "-c", "demo.c"], check=True, cwd=tmp_path)
    flags = ["-std=c++17", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"]
    subprocess.run([tool("g++"), *flags, "-o", "main", "main.cpp", "demo.o", "-lm"], check=True, cwd=tmp_path)
    run = subprocess.run([str(tmp_path / "main")], check=True, capture_output=True, text=True)
    assert float(run.stdout) == pytest.approx(evaluate(acrobot, "metric", q=[0.1, 0.4])["metric"][0][0], rel=1e-14)


@pytest.mark.parametrize("parts", [("acrobot",), ("cart-pendulum",), ("puma560",)])
def test_all_quantities_in_python_and_octave(parts: tuple[str, ...], tmp_path: Path) -> None:
    model = tree_of(*parts)
    exported = exported_of(model)
    module = load_python(write(exported, "python", tmp_path)[0].read_text(), tmp_path)
    write(exported, "matlab", tmp_path)
    values = state(exported.interface)
    for function in exported.functions:
        given = [values[n] for n in exported.interface.vectors["q"].names]
        arguments = [
            values["t"] if s == "t" else [values[n] for n in function.vector(s).names] for s in function.arguments
        ]
        found = getattr(module, exported.called(function))
        agree(by_output(function, found(*arguments)), function, values, 1e-11)
        if function.arguments == ("q", "p"):  # p is optional
            agree(by_output(function, found(given)), function, values, 1e-11)
        if function.quantity in ("metric", "christoffel", "forces", "kinematics"):
            agree(octave_call(exported, function, values, tmp_path), function, values, 1e-11)


def test_all_share_what_they_have_in_common(acrobot: Model, tmp_path: Path) -> None:
    exported = exported_of(acrobot, together=True)
    *single, together = exported.functions
    assert together.program.count()["total"] < sum(f.program.count()["total"] for f in single)
    library = shared([p for p in write(exported, "c", tmp_path) if p.name == "demo.c"])
    values = state(exported.interface)
    agree(call_c(library, exported, together, values), together, values)


def test_the_interface_as_a_document(acrobot: Model) -> None:
    ((name, data),) = files(exported_of(acrobot), "interface", LIMIT).items()
    told = json.loads(data)
    assert name == "demo_interface.json"
    assert told["vectors"]["q"]["names"] == ["i0.q1", "i0.q2"]
    assert told["vectors"]["p"]["names"] == list(acrobot.parameters)
    assert told["vectors"]["p"]["defaults"] == [float(p["value"]) for p in acrobot.parameters.values()]
    assert told["vectors"]["u"]["units"] == ["N m", "N m"]
    assert told["made_from"]["reference"] == "demo@1"
    metric = next(f for f in told["functions"] if f["quantity"] == "metric")
    assert (metric["arguments"], metric["outputs"][0]["shape"]) == (["q", "p"], [2, 2])


def test_a_caller_that_knows_the_interface_alone(acrobot: Model, tmp_path: Path) -> None:
    """Every function through the one entry that takes all vectors, by numbers and shapes of the document."""
    exported = exported_of(acrobot)
    library = shared([p for p in write(exported, "c", tmp_path) if p.name == "demo.c"])
    told = json.loads(files(exported, "interface", LIMIT)["demo_interface.json"])
    values = state(exported.interface)
    vectors = [np.array([values[n] for n in told["vectors"][s]["names"]]) for s in ("t", "q", "qd", "qdd", "u")]
    vectors += [np.zeros(0), np.array([values[n] for n in told["vectors"]["p"]["names"]])]
    given = (ctypes.c_void_p * 7)(*(v.ctypes.data for v in vectors))
    for k, each in enumerate(told["functions"]):
        results = {o["name"]: np.zeros(o["shape"]) for o in each["outputs"]}
        pointers = (ctypes.c_void_p * len(results))(*(a.ctypes.data for a in results.values()))
        assert getattr(library, f"{told['name']}_call")(k, given, pointers) == 0
        agree(results, exported.functions[k], values)
    assert getattr(library, f"{told['name']}_call")(len(told["functions"]), given, None) == 1


def test_octave_reads_the_interface(acrobot: Model, tmp_path: Path) -> None:
    exported = exported_of(acrobot)
    write(exported, "matlab", tmp_path)
    write(exported, "interface", tmp_path)
    script = (
        "s = jsondecode(fileread('demo_interface.json')); v = s.vectors; f = s.functions; k = 1;"
        "if iscell(f), f = f{1}; else, f = f(1); end;"
        "a = cellfun(@(n) 0.1*(1:v.(n).length)', f.arguments, 'UniformOutput', false); a{end} = v.p.defaults;"
        "printf('%.17g ', feval(f.name, a{:}));"
    )
    found = np.array(octave(script, tmp_path)[0].split(), dtype=float).reshape(2, 2)
    np.testing.assert_allclose(found, evaluate(acrobot, "metric", q=[0.1, 0.2])["metric"], rtol=1e-14)


def test_functions_of_parts(tmp_path: Path) -> None:
    part = shipped_part("acrobot")
    interface = interface_of_part(part)
    program = with_own_inertia(part, part.program.select(["metric"]))
    text = render(program, "python", name="arm", interface=interface, quantity="metric")
    module = load_python(text, tmp_path)
    np.testing.assert_allclose(
        module.arm_metric([0.3, 0.4]), evaluate(tree_of("acrobot"), "metric", q=[0.3, 0.4])["metric"], rtol=1e-14
    )
    left = render(part.program.select(["metric"]), "python", name="arm", interface=interface, quantity="metric")
    module = load_python(left, tmp_path)
    assert "arm_metric(q, x, p=P)" in left  # what may be mounted has the inertia symbols x


@pytest.mark.parametrize("target", sorted(TARGETS))
def test_the_same_bytes_for_the_same_request(target: str) -> None:
    first, second = (files(exported_of(make("acrobot")), target, LIMIT) for make in (tree_of, derived_anew))
    assert first == second
    about = [data for name, data in first.items() if not name.endswith((".c", ".wasm", ".mts"))]
    assert any(b"sha256:1" in data for data in about or first.values())  # a single C file says it itself


def test_unknown_targets_and_quantities_are_refused(acrobot: Model) -> None:
    with pytest.raises(InvalidArgument, match="'exe' is not one of") as caught:
        files(exported_of(acrobot), "exe", LIMIT)
    assert caught.value.faults[0].pointer == "/target"
    with pytest.raises(InvalidArgument, match="there is no quantity 'nonsense'"):
        exported_model(Sources(acrobot), interface_of_model(acrobot), ["nonsense"], "demo")
