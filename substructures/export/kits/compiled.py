"""Examples in compiled languages, and what builds them with the self-tests."""

from __future__ import annotations

from substructures.export.kits.example import VALUE, Example
from substructures.export.languages.code import indented
from substructures.export.languages.cpp import called as in_namespace
from substructures.export.languages.fortran import Fortran
from substructures.export.languages.rust import Rust, zeros


def c(e: Example) -> str:
    """In C99 and C89."""
    real, n = e.exported.real, e.name
    given = [*e.function.arguments, *e.outputs]
    declared = ["t = 0"] if "t" in e.function.arguments else []
    declared += [f"{s}[{max(1, size)}] = {{0}}" for s, size in (e.lengths | e.sizes).items()]
    body = [f"{real} {', '.join(declared)};"]
    body += [f"{n}_defaults(p);"] if "p" in e.lengths else []
    body += [f"{n}_prepare(p, w);"] if "w" in e.lengths else []
    if e.coordinate:
        body.append(f"q[{e.place(f'{n}_Q_{{}}')}] = {VALUE}; /* {e.coordinate} */")
    body += [f"{e.called}({', '.join(given)});", *e.shown(f'printf("%.9g\\n", {next(iter(e.outputs))}[0]);')]
    body += ["return 0;"]
    return "\n".join([f'#include "{n}.h"', "#include <stdio.h>", "", "int main(void) {", *indented(body), "}", ""])


def cpp(e: Example) -> str:
    """In C++17."""
    n, called = e.name, in_namespace(e.exported, e.function)
    body = ["double t = 0;"] if "t" in e.function.arguments else []
    body += [f"std::array<double, {size}> {s}{{}};" for s, size in e.lengths.items() if s != "p"]
    body += [f"auto p = {n}::defaults();"] if "p" in e.lengths else []
    if e.coordinate:
        body.append(f"q[{e.place(f'{n}::Q_{{}}')}] = {VALUE}; // {e.coordinate}")
    variable, shape = next(iter(e.outputs.items()))
    value = f"result.{variable}" if len(e.outputs) > 1 else "result"
    body += [f"[[maybe_unused]] const auto result = {called}({', '.join(e.function.arguments)});"]
    body += e.shown(f'std::printf("%.9g\\n", {value}{"[0]" if shape else ""});')
    return "\n".join([f'#include "{n}.hpp"', "#include <cstdio>", "", "int main() {", *indented(body), "}", ""])


def fortran(e: Example) -> str:
    """In Fortran 2018."""
    n = e.name
    declared = ["t = 0"] if "t" in e.function.arguments else []
    declared += [f"{s}({size}) = 0" for s, size in e.lengths.items()]
    declared += [s + (f"({', '.join(map(str, shape))})" if shape else "") for s, shape in e.outputs.items()]
    lines = [f"use {n}", "implicit none", f"double precision :: {', '.join(declared)}"]
    lines += [f"call {n}_defaults(p)"] if "p" in e.lengths else []
    if e.coordinate:
        lines.append(f"q({e.place(f'{n}_Q_{{}}', Fortran.alike, 1)}) = {VALUE} ! {e.coordinate}")
    lines.append(f"call {e.called}({', '.join([*e.function.arguments, *e.outputs])})")
    variable, shape = next(iter(e.outputs.items()))
    index = f"({', '.join('1' for _ in shape)})" if shape else ""
    lines += e.shown(f"print '(g0.9)', {variable}{index}")
    return "\n".join(["program example", *indented(lines), "end program", ""])


def rust(e: Example) -> str:
    """In Rust, edition 2024."""
    n, body = e.name, list[str]()
    for s, size in e.lengths.items():
        changed = "mut " if s == "q" and e.coordinate else ""
        body.append(f"let {changed}{s} = {f'{n}::P' if s == 'p' else f'[0.0; {size}]'};")
    body += [f"let mut {s} = {zeros(shape)};" for s, shape in e.outputs.items()]
    if e.coordinate:
        place = e.place("{}", Rust.alike)
        constant = place if place.isdigit() else f"{n}::at::Q_{place.upper()}"
        body.append(f"q[{constant}] = {VALUE}; // {e.coordinate}")
    given = ["0.0" if s == "t" else f"&{s}" for s in e.function.arguments] + [f"&mut {s}" for s in e.outputs]
    variable, shape = next(iter(e.outputs.items()))
    body += [f"{n}::{e.called}({', '.join(given)});", *e.shown(f'println!("{{}}", {variable}{"[0]" * len(shape)});')]
    return "\n".join(["fn main() {", *indented(body), "}", ""])


def cmake(e: Example) -> dict[str, str]:
    """The build of C."""
    n, standard = e.name, "90" if e.exported.standard == "c89" else "99"
    return {
        "CMakeLists.txt": f"""\
cmake_minimum_required(VERSION 3.16)
project({n} C)
set(CMAKE_C_STANDARD {standard})
add_library({n}_functions STATIC {n}.c)
target_include_directories({n}_functions PUBLIC ${{CMAKE_CURRENT_SOURCE_DIR}})
if(NOT MSVC)
  target_link_libraries({n}_functions PUBLIC m)
endif()
{_programs(n, "c")}"""
    }


def cmake_of_header(e: Example) -> dict[str, str]:
    """The build of C++."""
    n = e.name
    return {
        "CMakeLists.txt": f"""\
cmake_minimum_required(VERSION 3.16)
project({n} CXX)
add_library({n}_functions INTERFACE)
target_compile_features({n}_functions INTERFACE cxx_std_17)
target_include_directories({n}_functions INTERFACE ${{CMAKE_CURRENT_SOURCE_DIR}})
{_programs(n, "cpp")}"""
    }


def _programs(n: str, suffix: str) -> str:
    return f"""\
foreach(program {n}_selftest {n}_example)
  add_executable(${{program}} ${{program}}.{suffix})
  target_link_libraries(${{program}} PRIVATE {n}_functions)
endforeach()
enable_testing()
add_test(NAME {n}_selftest COMMAND {n}_selftest)
"""


def makefile(e: Example) -> dict[str, str]:
    """The build of Fortran."""
    n = e.name
    return {
        "Makefile": f"""\
FC = gfortran
FFLAGS = -O2 -std=f2018

all: {n}_selftest {n}_example

{n}.o: {n}.f90
\t$(FC) $(FFLAGS) -c {n}.f90

{n}_selftest: {n}.o {n}_selftest.f90
\t$(FC) $(FFLAGS) -o $@ {n}_selftest.f90 {n}.o

{n}_example: {n}.o {n}_example.f90
\t$(FC) $(FFLAGS) -o $@ {n}_example.f90 {n}.o
"""
    }


def cargo(e: Example) -> dict[str, str]:
    """The package of Rust."""
    n = e.name
    programs = "".join(f'\n[[bin]]\nname = "{n}_{x}"\npath = "{n}_{x}.rs"\n' for x in ("selftest", "example"))
    package = f'[package]\nname = "{n}"\nversion = "0.1.0"\nedition = "2024"\n'
    return {"Cargo.toml": f'{package}\n[lib]\npath = "{n}.rs"\n{programs}'}
