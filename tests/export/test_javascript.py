"""JavaScript with a module of WebAssembly, in Node: values, lengths, defaults, names that stay inert."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from catalogue_entries import shipped_part
from mixed_program import POINT, mixed_program
from run_code import agree, alone, arguments, state, tool

from substructures import Model, TreeSpec, couple
from substructures.export import Exported, Function, Interface, exported_model, files, interface_of_model
from substructures.expr.program import Program, Symbol
from substructures.quantities.sources import Sources

LIMIT = 1_000_000
#: prints what every call gives, or the name and the message of its error
CALLER = """
import { load } from "./%s.mjs";
import { readFileSync } from "node:fs";
const functions = await load();
const printed = JSON.parse(readFileSync("calls.json")).map(([name, given]) => {
    try {
        const result = functions[name](...given.map((x) => (x === null ? undefined : x)));
        const told = (array) => Array.from(array, String);
        return ArrayBuffer.isView(result)
            ? [told(result)]
            : Object.fromEntries(Object.entries(result).map(([key, array]) => [key, told(array)]));
    } catch (error) {
        return `${error.name}: ${error.message}`;
    }
});
console.log(JSON.stringify(printed));
"""


def run(exported: Exported, calls: Sequence[tuple[str, list[Any]]], folder: Path) -> list[Any]:
    """What the calls print."""
    for name, content in files(exported, "javascript", LIMIT).items():
        (folder / name).write_bytes(content)
    (folder / "calls.json").write_text(json.dumps(calls))
    (folder / "caller.mjs").write_text(CALLER % exported.name)
    command = [tool("node"), "caller.mjs"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=900, check=False)
    assert done.returncode == 0, done.stderr
    return list(json.loads(done.stdout))


def compare(printed: Any, function: Function, values: dict[str, float]) -> None:
    """With the interpreter."""
    names, outputs = list(function.program.outputs), printed
    if isinstance(printed, list):
        outputs = dict(zip(names, printed, strict=True))
    found = {n: [float(x) for x in outputs[n]] for n in names}
    agree(found, function, values, 1e-12)


@pytest.fixture(scope="module")
def acrobot() -> Model:
    spec = TreeSpec.read(
        {"name": "demo", "gravity": [0, 0, "-9.81"], "instances": [{"name": "i0", "substructure": "acrobot"}]}
    )
    return couple(spec, {"i0": shipped_part("acrobot")})


def exported_of(model: Model) -> Exported:
    quantities = ("metric", "christoffel", "forces", "forward_dynamics", "kinematics")
    return exported_model(Sources(model), interface_of_model(model), quantities, "demo")


def test_every_operation(tmp_path: Path) -> None:
    exported = alone(mixed_program())
    (function,) = exported.functions
    (printed,) = run(exported, [("model_any", list(arguments(function, POINT).values()))], tmp_path)
    compare(printed, function, POINT)


def test_functions_of_a_tree(acrobot: Model, tmp_path: Path) -> None:
    exported = exported_of(acrobot)
    values = state(exported.interface)
    calls = [(exported.called(f), list(arguments(f, values).values())) for f in exported.functions]
    calls += [(name, given[:-1]) for name, given in calls]  # p has its defaults
    for printed, function in zip(run(exported, calls, tmp_path), exported.functions * 2, strict=True):
        compare(printed, function, values)


def test_wrong_calls_are_refused(acrobot: Model, tmp_path: Path) -> None:
    exported = exported_of(acrobot)
    calls: list[tuple[str, list[Any]]] = [
        ("demo_metric", [[1.0]]),
        ("demo_metric", [[1.0, 2.0, 3.0]]),
        ("demo_metric", [3.0]),
        ("demo_metric", []),
        ("demo_metric", [[1.0, "2"]]),
        ("demo_metric", [[1.0, 2.0], None, 3.0]),
        ("demo_forces", [0.0, [1.0, 2.0], [0.0, 0.0], [0.0, 0.0], None]),
    ]
    errors = run(exported, calls, tmp_path)
    assert errors == [
        "RangeError: demo_metric: q has 2 numbers (i0.q1, i0.q2), not 1",
        "RangeError: demo_metric: q has 2 numbers (i0.q1, i0.q2), not 3",
        "RangeError: demo_metric: q has 2 numbers (i0.q1, i0.q2), not 3",
        "TypeError: demo_metric: q is missing (without default: i0.q1, i0.q2)",
        "TypeError: demo_metric: q[1] (i0.q2) is no number",
        "TypeError: demo_metric(q, p) takes 2 arguments, not 3",
        "TypeError: demo_forces(q, qd, u, p) takes 4 arguments, not 5",
    ]


def test_vectors_by_names(acrobot: Model, tmp_path: Path) -> None:
    """What has a default may be left out; nothing else may, and no name may be wrong."""
    exported = exported_of(acrobot)
    q = {"i0.q2": 0.4, "i0.q1": 0.3}
    heavy = [2.0 if name == "i0.m2" else x for name, x in zip(*_parameters(exported), strict=True)]
    calls: list[tuple[str, list[Any]]] = [("demo_metric", [q, {"i0.m2": 2.0}]), ("demo_metric", [[0.3, 0.4], heavy])]
    wrong = [
        ("demo_metric", [{"i0.q1": 1.0}]),
        ("demo_metric", [q, {"i0.m9": 2.0}]),
        ("demo_metric", [q, {"i0.m2": "2"}]),
    ]
    first, second, *errors = run(exported, [*calls, *wrong], tmp_path)
    assert first == second
    assert errors == [
        "TypeError: demo_metric: q needs a number for 'i0.q2'",
        "RangeError: demo_metric: p has no 'i0.m9' (i0.Ic1, i0.Ic2, i0.l1, i0.l2, i0.lc1, i0.lc2, i0.m1, i0.m2)",
        "TypeError: demo_metric: p needs a number for 'i0.m2'",
    ]


def _parameters(exported: Exported) -> tuple[tuple[str, ...], tuple[float, ...]]:
    p = exported.interface.vectors["p"]
    return p.names, p.defaults


def test_names_of_users_stay_inert(tmp_path: Path) -> None:
    names = ['</script><script>alert(1)//"@heap@"', "`${process.exit(3)}`", "\u2028 */ process.exit(4) /*", "@name@"]
    symbols = tuple(Symbol(name, "parameter") for name in names)
    operations = (("sym", 0), ("sym", 1), ("add", 0, 1), ("sym", 2), ("add", 2, 3), ("sym", 4 - 1), ("add", 4, 5))
    program = Program(symbols, operations, dict(mixed_program().select(["energy"]).outputs))
    output = program.outputs["energy"]
    program = Program(symbols, operations, {"energy": type(output)((), ((),), (6,))})
    interface = Interface.of_symbols(symbols)
    exported = Exported("model", interface, (Function("any", program, interface),))
    text = files(exported, "javascript", LIMIT)["model.mjs"].decode()
    assert "</script" not in text
    (printed,) = run(exported, [("model_any", [[], [], [], [], [1.0, 2.0, 3.0, 4.0]])], tmp_path)
    assert printed == [["10"]]


def test_types_name_every_function(acrobot: Model) -> None:
    text = files(exported_of(acrobot), "javascript", LIMIT)["demo.d.mts"].decode()
    assert "demo_metric(q: ArrayLike<number> | Coordinates, p?: ArrayLike<number> | Parameters): Float64Array;" in text
    assert "demo_forces(q: ArrayLike<number> | Coordinates, qd: ArrayLike<number> | Velocities, u: " in text
    assert '    /** i0.m2 [kg], default 1.0 */\n    "i0.m2"?: number;\n' in text
    assert '"rotation": Float64Array' in text
