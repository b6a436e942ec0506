"""What headers in C state: names of elements, and of each function operations and stack; and C89."""

from __future__ import annotations

import re
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from closed_trees import tree_model
from exported_models import exported_of, tree_of, write
from mechanics.reduced_parts import WISHBONE
from mixed_program import mixed_program
from run_code import STRICT, alone, call_c, shared, state, tool

from substructures import Model
from substructures.export import Exported
from substructures.export.reference import reference

OLD = ["-std=c89", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wdeclaration-after-statement", "-Werror"]


def as_c89(exported: Exported) -> Exported:
    return replace(exported, standard="c89")


@pytest.fixture(scope="module")
def models() -> list[Model]:
    return [tree_of("acrobot"), tree_of("scara", "camera"), tree_of("puma560")]


def measured(folder: Path, flags: list[str]) -> dict[str, int]:
    """Bytes of stack by function, of the compiler's own report."""
    subprocess.run([tool("gcc"), *flags, "-fstack-usage", "-c", "demo.c"], cwd=folder, check=True)
    rows = [line.split("\t") for line in (folder / "demo.su").read_text().splitlines()]
    return {where.rpartition(":")[2]: int(size) for where, size, *_ in rows}


@pytest.mark.parametrize("level", ["-O0", pytest.param("-O2", marks=pytest.mark.deep)])
def test_no_function_needs_more_stack_than_is_stated(models: list[Model], level: str, tmp_path: Path) -> None:
    for model in models:
        for given in ({}, {"standard": "c89"}, {"precision": "single"}):
            exported = replace(exported_of(model, together=True), **given)
            write(exported, "c", tmp_path)
            stated = re.findall(
                r"(\d+) operations, at most (\d+) bytes of stack.*\n(?:/.*\n)*void (\w+)",
                (tmp_path / "demo.h").read_text(),
            )
            found = measured(tmp_path, [f"-std={exported.standard}", level])
            assert [name for *_, name in stated] == [exported.called(each) for each in exported.functions]
            for (operations, size, name), function in zip(stated, exported.functions, strict=True):
                pieces = [found[each] for each in found if re.fullmatch(rf"{name}_\d+", each)]
                assert found[name] + max(pieces, default=0) <= int(size)
                assert int(operations) == function.program.count()["total"]


def test_a_larger_frame_would_be_seen(models: list[Model], tmp_path: Path) -> None:
    write(exported_of(models[0]), "c", tmp_path)
    path = tmp_path / "demo.c"
    head, body = "double *metric)\n{", "volatile double more[100]; more[0] = 0.0; (void)more;"
    path.write_text(path.read_text().replace(head, f"{head} {body}", 1))
    stated = re.search(r"at most (\d+) bytes of stack\nvoid demo_metric", (tmp_path / "demo.h").read_text())
    assert stated is not None
    assert measured(tmp_path, ["-std=c99", "-O2"])["demo_metric"] > int(stated[1])


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_c89_passes_its_self_test(models: list[Model], compiler: str, tmp_path: Path) -> None:
    for exported in map(as_c89, (alone(mixed_program(), "mixed"), exported_of(models[0], "arm"))):
        name = exported.name
        write(exported, "c", tmp_path)
        command = [tool(compiler), *OLD, "-o", "run", f"{name}.c", f"{name}_selftest.c", "-lm"]
        subprocess.run(command, cwd=tmp_path, check=True)
        assert subprocess.run([str(tmp_path / "run")], capture_output=True, text=True, check=True).stdout == "ok\n"


def test_c89_gives_the_same_bits(models: list[Model], tmp_path: Path) -> None:
    new, old = exported_of(models[1]), as_c89(exported_of(models[1]))
    libraries = []
    for exported, flags in ((new, STRICT), (old, OLD)):
        write(exported, "c", tmp_path)
        libraries.append(shared([tmp_path / "demo.c"], flags))
    values = state(new.interface)
    for function in new.functions:
        first, second = (call_c(library, new, function, values) for library in libraries)
        for name in first:
            np.testing.assert_array_equal(first[name], second[name])


def test_what_cannot_move_has_a_self_test_without_warnings(tmp_path: Path) -> None:
    """A tool has no coordinates, and so no forces to be compared."""
    exported = exported_of(tree_of("camera"))
    write(replace(exported, functions=exported.functions[7:8]), "c", tmp_path)
    command = [tool("gcc"), *STRICT, "-o", "run", "demo.c", "demo_selftest.c", "-lm"]
    subprocess.run(command, cwd=tmp_path, check=True)
    assert subprocess.run([str(tmp_path / "run")], capture_output=True, text=True, check=True).stdout == "ok\n"


def test_elements_have_names_units_and_defaults(models: list[Model], tmp_path: Path) -> None:
    write(exported_of(models[0]), "c", tmp_path)
    header = (tmp_path / "demo.h").read_text()
    assert re.search(r"demo_P_i0_m2 = \d+, // i0\.m2 \[kg\], default 1\.0\n", header)
    assert "demo_Q_i0_q1 = 0, // i0.q1 [rad]\n" in header
    assert "demo_U_tau_i0_q1 = 0, // tau.i0.q1 [N m]\n" in header


@pytest.mark.parametrize("precision", ["double", "single"])
def test_self_tests_compare_where_loops_are_closed(precision: str, tmp_path: Path) -> None:
    """A suspension, whose loops are open at the usual position, by steps of Newton's method."""
    tree = {"gravity": [0, 0, "-9.81"], "instances": [{"name": "x", "substructure": "wishbone"}]}
    exported = replace(exported_of(tree_model(tree, {"wishbone": WISHBONE})), precision=precision)
    assert all(call.checks for call in reference(exported))
    write(exported, "c", tmp_path)
    command = [tool("gcc"), *STRICT, "-o", "run", "demo.c", "demo_selftest.c", "-lm"]
    subprocess.run(command, cwd=tmp_path, check=True)
    assert subprocess.run([str(tmp_path / "run")], capture_output=True, text=True, check=True).stdout == "ok\n"
