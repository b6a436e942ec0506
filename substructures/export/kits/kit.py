"""The README, example and build file of each target that is a zip of code."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from substructures.export.exported import Exported
from substructures.export.kits import compiled, scripts
from substructures.export.kits.example import Example
from substructures.export.languages.code import NOT_EXECUTED
from substructures.printers.names import comment

Files = dict[str, bytes]


@dataclass(frozen=True)
class Kit:
    """``language``: its name and that of its code blocks; ``suffix`` of the example, behind ``NAME_example``;
    ``needs``: what has to be installed; ``commands``: with {0} for the name; ``build``: further files."""

    language: str
    fence: str
    suffix: str
    needs: str
    commands: tuple[str, ...]
    example: Callable[[Example], str]
    build: Callable[[Example], Mapping[str, str]] = lambda _: {}
    executed: bool = True


_CMAKE = ("cmake -S . -B build", "cmake --build build", "./build/{0}_selftest", "./build/{0}_example")
_MAKE = ("make", "./{0}_selftest", "./{0}_example")
_CARGO = ("cargo run --quiet --bin {0}_selftest", "cargo run --quiet --bin {0}_example")
KITS: Mapping[str, Kit] = {
    "c": Kit("C", "c", ".c", "a C compiler and CMake", _CMAKE, compiled.c, compiled.cmake),
    "cpp": Kit("C++17", "cpp", ".cpp", "a C++ compiler and CMake", _CMAKE, compiled.cpp, compiled.cmake_of_header),
    "fortran": Kit("Fortran 2018", "fortran", ".f90", "gfortran", _MAKE, compiled.fortran, compiled.makefile),
    "rust": Kit("Rust", "rust", ".rs", "Rust 1.85 or later", _CARGO, compiled.rust, compiled.cargo),
    "python": Kit(
        "Python", "python", ".py", "NumPy", ("python3 {0}_selftest.py", "python3 {0}_example.py"), scripts.python
    ),
    "jax": Kit(
        "JAX", "python", "_jax.py", "JAX", ("python3 {0}_jax_selftest.py", "python3 {0}_example_jax.py"), scripts.jax
    ),
    "javascript": Kit(
        "JavaScript",
        "javascript",
        ".mjs",
        "Node, or a browser",
        ("node {0}_selftest.mjs", "node {0}_example.mjs"),
        scripts.javascript,
        scripts.package,
    ),
    "matlab": Kit(
        "MATLAB and Octave",
        "matlab",
        ".m",
        "MATLAB, or Octave as here",
        ('octave-cli --eval "{0}_selftest"', "octave-cli {0}_example.m"),
        scripts.matlab,
    ),
    "simulink": Kit(
        "Simulink",
        "matlab",
        "_simulink.m",
        "MATLAB, Simulink and a C compiler",
        ('matlab -r "{0}_example_simulink"',),
        scripts.simulink,
        executed=False,
    ),
    "julia": Kit(
        "Julia",
        "julia",
        ".jl",
        "Julia",
        ("julia {0}_selftest.jl", "julia {0}_example.jl"),
        scripts.julia,
        executed=False,
    ),
}


def kit(exported: Exported, target: str, main: str) -> Files:
    """The files beside those of a target, of which ``main`` has the head that lists everything."""
    given, example = KITS[target], Example(exported)
    name, text = f"{exported.name}_example{given.suffix}", given.example(example)
    made = {name: text, **given.build(example), "README.md": _readme(example, given, name, text, main)}
    return {file: content.encode() for file, content in made.items()}


def _readme(e: Example, given: Kit, file: str, text: str, main: str) -> str:
    interface = e.exported.interface
    about = ", ".join(
        comment(part) for part in (interface.reference.replace("@", " version "), interface.digest) if part
    )
    title = f"{e.name}: functions of a mechanism in {given.language}"
    origin = f"Made from {about}. " if about else ""
    commands = "\n".join(given.commands).format(e.name)
    tested = "the self-test, which ends with `ok`, and " * any("selftest" in each for each in given.commands)
    executed = "" if given.executed else f"\n{NOT_EXECUTED}\n"
    return f"""\
# {title}

{origin}The head of `{main}` lists the functions, and what stands where in their arguments: names, units and defaults.
{executed}
With {given.needs}, {tested}the example, `{file}`:

```sh
{commands}
```

```{given.fence}
{text}```
"""
