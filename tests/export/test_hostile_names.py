"""Names and units from outside cannot leave their comment or string, in any target."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from io import BytesIO
from pathlib import Path
from zipfile import ZipFile

import pytest
from defusedxml.ElementTree import fromstring
from run_code import STRICT, octave, tool

from substructures.errors import InvalidArgument
from substructures.export import FORMATS, TARGETS, Exported, Function, Interface, Vector, files, render
from substructures.expr.program import Output, Program, Symbol
from substructures.printers import FORMATS as WRITTEN

sys.path.insert(0, str(Path(__file__).parent.parent / "expr"))
from test_injection import NASTY, code_only

MARKS = {"c": "//", "matlab": "%", "julia": "#"}


def exported(names: list[str], reference: str = "") -> Exported:
    """Every name as name and unit of a symbol, as name of an output and as quantity."""
    symbols = tuple(Symbol(n, "parameter", n) for n in names)
    operations = (*(("sym", i) for i in range(len(names))), ("add", 0, 1), ("mul", 2, 3))
    outputs = {n: Output((2,), ((0,), (1,)), (len(names), len(names) + 1)) for n in names}
    interface = Interface(Interface.of_symbols(symbols).vectors, reference, reference)
    program = Program(symbols, operations, outputs)
    return Exported("model", interface, tuple(Function(n, program, interface) for n in names[:3]))


PLAIN = exported([f"n{i}" for i in range(len(NASTY))], "plain")
HOSTILE = exported(NASTY, " ".join(NASTY))


@pytest.mark.parametrize("target", sorted(set(TARGETS) - {"fmu", "fmu2", "simulink"}))
def test_names_do_not_leave_their_line(target: str) -> None:
    plain, nasty = files(PLAIN, target, 10**6), files(HOSTILE, target, 10**6)
    if target == "interface":  # JSON
        return
    assert len(plain) == len(nasty)
    for name, data in nasty.items():
        if name.endswith(".wasm"):
            assert len(data) == len(plain[name])
            assert not [each for each in NASTY if len(each) > 8 and each.encode() in data]
            continue
        text = data.decode()
        assert text.isascii()
        assert not set(text) - set(map(chr, range(32, 127))) - {"\n", *("\t" * (name == "Makefile"))}
        # in Python and JavaScript names stand in strings, whose ends are escaped
        assert target in ("python", "jax", "sympy", "javascript") or "*/ int" not in text
        mark = MARKS.get(target, "")
        if mark and name != "README.md":
            assert not re.search("boom|import os|system|passwd", code_only(text, mark))


@pytest.mark.parametrize("target", ["fmu", "fmu2"])
def test_an_fmu_has_plain_names_alone(target: str) -> None:
    """Names stand in its XML and nowhere else; what it was made from is escaped."""
    vectors = HOSTILE.interface.vectors
    output = {"forward_dynamics": Output((1,), ((0,),), (0,))}
    for k, nasty in enumerate(["q1", *(name for name in NASTY if not re.fullmatch(r"[\w.]+", name, re.ASCII))]):
        program = Program((Symbol(nasty, "coordinate"),), (("sym", 0),), output)
        q = Vector("q", (nasty,), ("rad",))
        states = {"q": q, "qd": Vector("qd", (f"{nasty}'",), ("",)), "qdd": Vector("qdd", (f"{nasty}''",), ("",))}
        interface = Interface({**vectors, **states, "p": Vector("p", (), ())}, " ".join(NASTY), " ".join(NASTY))
        moving = Exported("model", interface, (Function("forward_dynamics", program, interface),))
        if k:
            with pytest.raises(InvalidArgument, match="no name of a variable"):
                files(moving, target, 10**6)
            continue
        packed = ZipFile(BytesIO(files(moving, target, 10**6)["model.fmu"]))
        root = fromstring(packed.read("modelDescription.xml"))
        assert root.attrib["modelName"] == "model"
        assert {each.tag for each in root} <= {
            *("ModelExchange", "CoSimulation", "UnitDefinitions", "LogCategories", "DefaultExperiment"),
            *("ModelVariables", "ModelStructure"),
        }


@pytest.mark.parametrize("target", ["python", "jax", "sympy"])
def test_python_has_the_same_structure_whatever_the_names(target: str) -> None:
    name, text = next(iter(files(HOSTILE, target, 10**6).items()))
    tree = ast.parse(text)
    called = {ast.unparse(n.func) for n in ast.walk(tree) if isinstance(n, ast.Call)}
    assert not {c for c in called if re.search("system|import|eval|exec|open|boom", c)}
    kinds = {type(n) for n in tree.body}
    assert kinds <= {ast.Expr, ast.Import, ast.ImportFrom, ast.Assign, ast.FunctionDef, ast.ClassDef}
    imported = [ast.unparse(n) for n in tree.body if isinstance(n, (ast.Import, ast.ImportFrom))]
    assert imported == [ast.unparse(n) for n in ast.parse(files(PLAIN, target, 10**6)[name]).body if "Import" in str(n)]
    members = [n for each in tree.body if isinstance(each, ast.ClassDef) for n in each.body]
    assert {type(n) for n in members} <= {ast.Expr, ast.AnnAssign}


def test_c_has_the_same_functions_whatever_the_names(tmp_path: Path) -> None:
    for name, data in files(HOSTILE, "c", 10**6).items():
        (tmp_path / name).write_bytes(data)
    command = [tool("gcc"), *STRICT, "-trigraphs", "-Wcomment", "-c", "-o", "nasty.o", "model.c"]
    subprocess.run(command, check=True, cwd=tmp_path)
    plain = files(PLAIN, "c", 10**6)["model.c"].decode()
    nasty = (tmp_path / "model.c").read_text()
    heads = [len(re.findall(r"^\w.*\(", code_only(text, "//"), re.MULTILINE)) for text in (plain, nasty)]
    assert heads[0] == heads[1] == 3 + 2


def test_octave_reads_files_with_hostile_comments(tmp_path: Path) -> None:
    for name, data in files(HOSTILE, "matlab", 10**6).items():
        (tmp_path / name).write_bytes(data)
    assert octave("y0 = model_f1(0, [], [], [], []); disp(numel(y0));", tmp_path)[0].strip() == "2"


@pytest.mark.parametrize("name", [*NASTY, "a b", "9a", "é", "class", "End", "x" * 33])
@pytest.mark.parametrize("format_", sorted(set(FORMATS) - set(WRITTEN)))
def test_a_prefix_that_is_no_identifier_is_refused(name: str, format_: str) -> None:
    if name in ("metric", "model", "t1"):
        return
    with pytest.raises(InvalidArgument, match=r"identifier|word of one of") as caught:
        render(PLAIN.functions[0].program, format_, name=name, interface=PLAIN.interface)
    assert caught.value.faults[0].pointer == "/name"


def test_code_without_an_interface_is_refused() -> None:
    with pytest.raises(InvalidArgument, match="interface_of_model"):
        render(PLAIN.functions[0].program, "c")
