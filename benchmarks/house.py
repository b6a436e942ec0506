"""How easily a reader finds the way in the house: rooms and floors, chains of imports, comments, docstrings, stories.

python -m benchmarks.house [CHECKOUT] [--json FILE]

CHECKOUT is a folder with ``substructures/`` and ``service/``; default: the repository of this file. Nothing of it is
imported here; only the stories run it, in a process of their own (benchmarks/stories.py). What the figures mean:

import       of one module by another of the checkout, anywhere in the file; ``from a import b`` means the module
             ``a.b`` if there is one, else ``a``. Modules that are imported by name at run time do not count.
rooms        of a folder: the modules and subfolders directly in it that hold code, its ``__init__`` left out; "fuller"
             are folders that have more than 25
floors       rooms on the longest path of imports between the rooms; rooms that import each other in a circle are one,
             and the circle is told
chain        the same between all modules of a package, and between its folders (a module stands for its folder, one in
             the root for itself; the package's own ``__init__`` is left out)
comments     share of the lines of the files that hold nothing but a ``#`` comment; docstrings do not count
docstrings   functions, methods and classes whose names do not begin with an underscore, wherever they are defined,
             and how many of these have no docstring
stories      modules that one opens to understand how something works: see benchmarks/stories.py
quantity     files of code that name the quantity which the most name, of those added last: what one more touches
long         functions of more than 40 lines, files of more than 300

The house may only become better: tests/test_house.py compares these figures with those of tests/house.json.
"""

from __future__ import annotations

import argparse
import ast
import io
import json
import os
import re
import subprocess
import sys
import tokenize
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

PACKAGES = ("substructures", "service")
CODE = (*PACKAGES, "migrations")
#: what a folder holds at most without being listed
ROOMS = 25
#: the quantities that were added last
NEWEST = ("mass_centre", "centroidal_momentum_matrix")
#: lines that a function and a file have at most without being counted
FUNCTION, FILE = 40, 300
STORIES = Path(__file__).with_name("stories.py")
Graph = Mapping[str, set[str]]


def modules(root: Path) -> dict[str, Path]:
    """The files of both packages by the names of their modules."""
    files = [file for package in PACKAGES for file in sorted((root / package).rglob("*.py"))]
    names = [".".join(file.relative_to(root).with_suffix("").parts).removesuffix(".__init__") for file in files]
    return dict(zip(names, files, strict=True))


def sources(root: Path) -> list[Path]:
    """All files of code, without tests."""
    return [file for folder in CODE for file in sorted((root / folder).rglob("*.py"))]


def imports(root: Path) -> dict[str, set[str]]:
    """Module -> modules of the checkout that it imports."""
    known = modules(root)
    return {name: {other for other in _imported(name, file, known) if other != name} for name, file in known.items()}


def _imported(name: str, file: Path, known: Mapping[str, Path]) -> set[str]:
    found: set[str] = set()
    for node in _statements(file)[0]:
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        else:
            package = name.split(".") if file.name == "__init__.py" else name.split(".")[:-1]
            above = package[: len(package) - node.level + 1] if node.level else []
            base = ".".join([*above, *filter(None, [node.module])])
            found.update(f"{base}.{alias.name}" if f"{base}.{alias.name}" in known else base for alias in node.names)
    return found & known.keys()


@cache
def _statements(file: Path) -> tuple[list[ast.Import | ast.ImportFrom], dict[str, int]]:
    """The imports of a file, and its functions with their lines, docstring included."""
    imported: list[ast.Import | ast.ImportFrom] = []
    functions: dict[str, int] = {}
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import | ast.ImportFrom):
            imported.append(node)
        elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            functions[f"{node.name}:{node.lineno}"] = (node.end_lineno or node.lineno) - node.lineno + 1
    return imported, functions


def contracted(graph: Graph, place: Callable[[str], str | None]) -> dict[str, set[str]]:
    """The graph between the places of modules; those without a place are left out."""
    result: dict[str, set[str]] = {}
    for name, others in graph.items():
        here = place(name)
        if here is not None:
            there = {place(other) for other in others} - {here, None}
            result.setdefault(here, set()).update(each for each in there if each is not None)
    return result


def circles(graph: Graph) -> list[list[str]]:
    """Strongly connected components, what is imported first."""
    reached = {name: _reached(graph, name) for name in graph}
    groups = {tuple(sorted(o for o in reached[n] | {n} if o == n or n in reached[o])) for n in graph}
    return sorted(map(list, groups), key=lambda group: (len(reached[group[0]] | {*group}), group))


def _reached(graph: Graph, start: str) -> set[str]:
    found: set[str] = set()
    waiting = [start]
    while waiting:
        new = graph.get(waiting.pop(), set()) - found
        found |= new
        waiting += new
    return found


def longest(graph: Graph) -> list[str]:
    """The longest path of imports, from the top to what imports nothing; a circle counts once."""
    groups = circles(graph)
    group_of = {name: k for k, group in enumerate(groups) for name in group}
    below: list[list[str]] = []
    for k, group in enumerate(groups):
        others = {group_of[other] for name in group for other in graph[name]} - {k}
        path = max((below[o] for o in sorted(others)), key=len, default=[])
        below.append([" = ".join(group), *path])
    return max(below, key=len, default=[])


def floors(graph: Graph) -> dict[str, Any]:
    """Rooms, floors, circles, and a longest path."""
    path = longest(graph)
    return {
        "rooms": len(graph),
        "floors": len(path),
        "circles": [g for g in circles(graph) if len(g) > 1],
        "path": path,
    }


def room_in(folder: str) -> Callable[[str], str | None]:
    """The room of a module in a folder."""
    return lambda name: name[len(folder) + 1 :].split(".")[0] if name.startswith(f"{folder}.") else None


def rooms(root: Path) -> dict[str, int]:
    """By folder how many rooms it has."""
    paths = [name.split(".") for name in modules(root)]
    places = {tuple(path[:k]) for path in paths for k in range(2, len(path) + 1)}
    return dict(Counter(".".join(place[:-1]) for place in places))


def longest_chains(root: Path) -> dict[str, list[str]]:
    """By package the longest chain of imports between its modules."""
    graph = imports(root)
    return {package: longest(contracted(graph, within(package))) for package in PACKAGES}


def naming(root: Path, quantity: str) -> list[str]:
    """Files of code in which a quantity is named, or a name begins with it."""
    named = re.compile(rf"\b{quantity}")
    return [str(file.relative_to(root)) for file in sources(root) if named.search(file.read_text())]


def long_functions(root: Path) -> dict[str, int]:
    """Functions of more than FUNCTION lines: ``file:function:line`` -> how many they have."""
    return {
        f"{file.relative_to(root)}:{name}": lines
        for file in sources(root)
        for name, lines in _statements(file)[1].items()
        if lines > FUNCTION
    }


def long_files(root: Path) -> dict[str, int]:
    """Files of more than FILE lines, and how many they have."""
    sizes = {str(file.relative_to(root)): len(file.read_text().splitlines()) for file in sources(root)}
    return {name: lines for name, lines in sizes.items() if lines > FILE}


def bounds(root: Path) -> dict[str, dict[str, int]]:
    """What tests/test_house.py keeps from becoming worse."""
    return {
        "rooms": {folder: n for folder, n in sorted(rooms(root).items()) if n > ROOMS},
        "chains": {package: len(path) for package, path in longest_chains(root).items()},
        "long": {"functions": len(long_functions(root)), "files": len(long_files(root))},
    }


def within(package: str) -> Callable[[str], str | None]:
    """The module itself, if it belongs to the package."""
    return lambda name: name if name.split(".")[0] == package else None


def comments(files: Iterable[Path]) -> dict[str, Any]:
    """Lines, and those that are comments."""
    lines = found = 0
    for file in files:
        text = file.read_text()
        lines += len(text.splitlines())
        tokens = tokenize.generate_tokens(io.StringIO(text).readline)
        found += sum(t.type == tokenize.COMMENT and t.line.lstrip().startswith("#") for t in tokens)
    return {"lines": lines, "comments": found, "percent": round(100 * found / lines, 2) if lines else None}


def docstrings(files: Iterable[Path]) -> dict[str, dict[str, int]]:
    """Public functions (with methods) and classes, and those without docstring."""
    result = {kind: {"public": 0, "without": 0} for kind in ("functions", "classes")}
    for file in files:
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef) and not node.name.startswith(
                "_"
            ):
                counted = result["classes" if isinstance(node, ast.ClassDef) else "functions"]
                counted["public"] += 1
                counted["without"] += ast.get_docstring(node) is None
    return result


def measured(root: Path) -> dict[str, Any]:
    """All figures of a checkout."""
    graph, known = imports(root), modules(root)
    inside = {package: contracted(graph, within(package)) for package in PACKAGES}
    rooms = {
        folder: floors(contracted(graph, room_in(folder)))
        for folder in ("substructures", "substructures.analysis", "service")
    }
    files = {folder: len(list((root / folder.replace(".", "/")).glob("*.py"))) for folder in rooms}

    def folder_of(name: str) -> str | None:
        if name in PACKAGES:
            return None
        is_folder = known[name].name == "__init__.py" or name.count(".") == 1
        return name if is_folder else name.rpartition(".")[0]

    science = {name: file for name, file in known.items() if name.startswith("substructures.")}
    coupling = [f for name, f in science.items() if name.split(".")[1] in ("part", "tree")]
    places = {
        "substructures": science.values(),
        "service": [file for name, file in known.items() if name.startswith("service")],
        "mechanics": [file for name, file in science.items() if name.startswith("substructures.mechanics")],
        "part and tree": coupling,
        "analysis": [file for name, file in science.items() if name.startswith("substructures.analysis")],
    }
    return {
        "rooms": {folder: {"files": files[folder], **figures} for folder, figures in rooms.items()},
        "chains of modules": {package: floors(g) for package, g in inside.items()},
        "chains of folders": {package: floors(contracted(g, folder_of)) for package, g in inside.items()},
        "comments": {"all": comments(known.values()), **{place: comments(some) for place, some in places.items()}},
        "docstrings": {"all": docstrings(known.values()), **{p: docstrings(places[p]) for p in PACKAGES}},
        "stories": stories(root),
        "lines": {
            "source": sum(len(file.read_text().splitlines()) for file in sources(root)),
            "tests": sum(len(file.read_text().splitlines()) for file in (root / "tests").rglob("*.py")),
        },
        "files of a quantity": {quantity: naming(root, quantity) for quantity in NEWEST},
        "bounds": bounds(root),
    }


def stories(root: Path) -> dict[str, Any]:
    """What benchmarks/stories.py tells of a checkout."""
    command, environment = [sys.executable, "-P", str(STORIES), str(root)], {**os.environ, "PYTHONPATH": str(root)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300, check=False)
    if done.returncode:
        return {"failed": done.stderr.strip().splitlines()[-1:]}
    told: dict[str, Any] = json.loads(done.stdout)
    return told


def summary(figures: Mapping[str, Any]) -> dict[str, str]:
    """What matters most, a line each."""
    folders, chains, stories_ = figures["rooms"], figures["chains of modules"], figures["stories"]
    root = {name: f"{folders[name]['rooms']} / {folders[name]['floors']}" for name in PACKAGES}
    return {
        "science, root: rooms / floors": root["substructures"],
        "service, root: rooms / floors": root["service"],
        "longest chain of modules, science / service": " / ".join(str(chains[p]["floors"]) for p in PACKAGES),
        "modules one opens: g / Gamma over HTTP / a job item": "failed"
        if "failed" in stories_
        else " / ".join(str(len(each)) for each in stories_.values()),
        "files that one new quantity touches": str(max(map(len, figures["files of a quantity"].values()))),
        "comment lines in part, tree": f"{figures['comments']['part and tree']['percent']} %",
        "lines of source / tests": " / ".join(str(figures["lines"][what]) for what in ("source", "tests")),
        "functions / files with many lines": " / ".join(map(str, figures["bounds"]["long"].values())),
        "fuller folders": ", ".join(f"{name} {n}" for name, n in figures["bounds"]["rooms"].items()),
    }


def show(figures: Mapping[str, Any]) -> None:
    """The figures as a table."""
    for name, told in summary(figures).items():
        print(f"{name:52} {told}")
    print()
    print(f"{'':40} {'files':>6} {'rooms':>6} {'floors':>7}")
    for title in ("rooms", "chains of modules", "chains of folders"):
        for folder, each in figures[title].items():
            name = folder if title == "rooms" else f"{folder}, {title.removeprefix('chains of ')}"
            print(f"{name:40} {each.get('files', ''):>6} {each['rooms']:>6} {each['floors']:>7}")
            for group in each["circles"]:
                print(f"    circle: {' = '.join(group)}")
    print("\ncomment lines")
    for place, each in figures["comments"].items():
        print(f"{place:40} {each['comments']:>6} of {each['lines']:>6} lines {each['percent']:>6} %")
    print("\npublic, and of these without docstring")
    for place, kinds in figures["docstrings"].items():
        print(f"{place:40} " + ", ".join(f"{c['public']} {kind}, {c['without']} without" for kind, c in kinds.items()))
    print("\nmodules of a story")
    for story, each in figures["stories"].items():
        print(f"{story:40} {len(each):>6}  {', '.join(each)}")


def main() -> None:
    """Print the figures; with --json FILE write them."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("checkout", nargs="?", type=Path, default=Path(__file__).parents[1])
    parser.add_argument(
        "--json", type=Path, metavar="FILE", help="write all figures, with paths and names, to this file"
    )
    options = parser.parse_args()
    figures = measured(options.checkout.resolve())
    show(figures)
    if options.json is not None:
        options.json.write_text(json.dumps(figures, indent=1) + "\n")


if __name__ == "__main__":
    main()
