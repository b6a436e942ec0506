"""The package as its users import it: every public name, nothing heavy before it is asked for, the client alone."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path
from symtable import Symbol, symtable

import pytest

import substructures

FOLDERS = "analysis|expr|loads|mechanics|part|quantities|tree"
SOURCE = Path(substructures.__file__ or "").read_text()


@pytest.mark.parametrize("name", substructures.__all__)
def test_public_names(name: str) -> None:
    value = getattr(substructures, name)
    assert name in dir(substructures)
    if isinstance(value, type):
        assert value.__name__ == name


PLACES = sorted(set(re.findall(rf"\b(?:{FOLDERS})(?:\.\w+)+", substructures.__doc__ or "")))


@pytest.mark.parametrize("place", PLACES)
def test_the_map_names_what_there_is(place: str) -> None:
    folder, module, *name = place.split(".")
    found = import_module(f"substructures.{folder}.{module}")
    assert all(hasattr(found, each) for each in name)


def test_the_notation_names_modules_that_there_are() -> None:
    page = (Path(__file__).parents[1] / "docs" / "explanation" / "notation.md").read_text()
    places = set(re.findall(rf"\b(?:{FOLDERS})/\w+(?:/\w+)*", page))
    assert len(places) > 10
    for place in places:
        import_module("substructures." + place.replace("/", "."))


def test_unknown_name() -> None:
    with pytest.raises(AttributeError, match="'substructures' has no attribute 'simulat'"):
        getattr(substructures, "simulat")  # noqa: B009 a type checker would refuse the attribute


def test_what_type_checkers_see_is_what_there_is() -> None:
    (block,) = (node for node in ast.parse(SOURCE).body if isinstance(node, ast.If))
    seen = {
        (node.module, alias.name) for node in block.body if isinstance(node, ast.ImportFrom) for alias in node.names
    }
    there = {(module, name) for module, names in substructures._WHERE.items() for name in names}
    assert seen == there | {("substructures", "catalogue")}


def test_variables_of_comprehensions_have_no_names_that_others_take_of_the_module() -> None:
    """With both in one function CPython 3.12.1 raises UnboundLocalError: it looks for the second in the function."""
    root = Path(__file__).parents[1]
    files = [path for folder in ("substructures", "service") for path in (root / folder).rglob("*.py")]
    tables = [(path.name, symtable(path.read_text(), path.name, "exec")) for path in files]
    for name, table in tables:
        tables += [(name, child) for child in table.get_children()]
        symbols = [
            s
            for c in table.get_children()
            if c.get_name() in ("listcomp", "setcomp", "dictcomp")
            for s in c.get_symbols()
        ]
        own, taken = ({s.get_name() for s in symbols if test(s)} for test in (Symbol.is_local, Symbol.is_global))
        assert not own & taken, f"{name}, line {table.get_lineno()}: {own & taken}"


def test_client_beside_a_service_of_ones_own(tmp_path: Path) -> None:
    """The client imports nothing of the service, so a user's file ``service.py`` does not get in its way."""
    (tmp_path / "service.py").write_text("raise RuntimeError('the service of somebody else')")
    (tmp_path / "use.py").write_text(
        "from substructures.client import Client\nimport sys\nClient('http://127.0.0.1:9').close()\n"
        "print(*(name for name in ('fastapi', 'sqlalchemy', 'scipy', 'sympy', 'service') if name in sys.modules))"
    )
    done = subprocess.run([sys.executable, "use.py"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.stdout.strip(), done.stderr) == ("", "")
