"""Runs Maxima and FriCAS, and reads the numbers that they print."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from mixed_program import POINT
from run_code import tool

from substructures.export import Exported, Function
from substructures.export.reference import arguments


def maxima(script: str, folder: Path) -> list[str]:
    (folder / "script.mac").write_text(script)
    command = [tool("maxima"), "--very-quiet", '--batch-string=load("script.mac")$']
    run = subprocess.run(command, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=900)
    assert run.returncode == 0, run.stdout + run.stderr
    assert "error" not in run.stdout.lower(), run.stdout
    return run.stdout.splitlines()


def fricas(script: str, folder: Path) -> str:
    (folder / "script.input").write_text(script)
    command = [tool("fricas"), "-nosman", "-eval", ")read script.input )quiet", "-eval", ")quit"]
    run = subprocess.run(command, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=900)
    return run.stdout


def rational(x: float) -> str:
    numerator, denominator = x.as_integer_ratio()
    return f"({numerator}/{denominator})"


def values(function: Function) -> dict[str, float]:
    """Where every function is real."""
    pairs = arguments(function).items()
    found = {n: x for s, some in pairs for n, x in zip(function.vector(s).names, some, strict=True)}
    return {**found, **POINT} if set(POINT) == set(found) - {"t"} else found


def double(x: float) -> str:
    """Of Maxima, this one exactly, however decimals are read there."""
    return f"float{rational(x)}"


def given(function: Function, number: Callable[[float], str] = rational) -> list[str]:
    known = values(function)
    columns = {s: [number(known[n]) for n in function.vector(s).names] for s in function.arguments}
    return [column[0] if s == "t" else f"[{', '.join(column)}]" for s, column in columns.items()]


def split_numbers(text: str, function: Function) -> dict[str, Any]:
    numbers = [float(x) for x in re.findall(r"-?\d[\d.]*(?:[eE][+-]?\d+)?", text.replace("- ", "-"))]
    found, start = {}, 0
    for name, output in function.program.outputs.items():
        size = int(np.prod(output.shape))
        found[name] = np.array(numbers[start : start + size]).reshape(output.shape)
        start += size
    assert start == len(numbers), text
    return found


def numbers_in_maxima(
    exported: Exported, path: Path, number: Callable[[float], str] = rational
) -> list[dict[str, Any]]:
    """The outputs of every function of an exported file at :func:`values`: of rational arguments by exact arithmetic,
    sines of them being symbols, which takes large models a minute, or of doubles (``number=double``).
    """
    script = f'load("{path.name}")$ fpprintprec: 17$ linel: 100000$ \n'
    script += "plain(x) := if matrixp(x) then plain(args(x)) elseif listp(x) then map(plain, x) else float(x)$\n"
    for function in exported.functions:
        call = f"{exported.called(function)}({', '.join(given(function, number))})"
        script += f"print(flatten([plain({call})]))$\n"
    lines = [line for line in maxima(script, path.parent) if line.startswith("[")]
    assert len(lines) == len(exported.functions)
    return [split_numbers(line, function) for function, line in zip(exported.functions, lines, strict=True)]
