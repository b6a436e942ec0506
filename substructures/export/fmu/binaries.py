"""Shared libraries from the sources of an FMU, with the compilers that are at hand.

``cc`` (or gcc, clang) makes that of this platform; with the wheel ``ziglang`` (extra ``cross``) those of others are
made, too. What is compiled was written here, and is not run.
"""

from __future__ import annotations

import platform
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

_FLAGS = ("-std=c99", "-O2", "-shared", "-fPIC", "-fvisibility=hidden", "-Wl,--build-id=none")
_SECONDS = 300


@dataclass(frozen=True)
class _Platform:
    """``folders``: of version 3.0 and 2.0; ``triple``: as Zig calls it."""

    folders: tuple[str, str]
    suffix: str
    triple: str


_PLATFORMS: Mapping[tuple[str, str], _Platform] = {
    ("Linux", "x86_64"): _Platform(("x86_64-linux", "linux64"), ".so", "x86_64-linux-gnu"),
    ("Linux", "aarch64"): _Platform(("aarch64-linux", "aarch64-linux"), ".so", "aarch64-linux-gnu"),
    ("Darwin", "x86_64"): _Platform(("x86_64-darwin", "darwin64"), ".dylib", "x86_64-macos"),
    ("Darwin", "arm64"): _Platform(("aarch64-darwin", "aarch64-darwin"), ".dylib", "aarch64-macos"),
    ("Windows", "AMD64"): _Platform(("x86_64-windows", "win64"), ".dll", "x86_64-windows-gnu"),
}


def libraries(sources: Mapping[str, bytes], name: str, version: str) -> dict[str, bytes]:
    """Libraries by their places in the FMU; none where there is no compiler. Raises RuntimeError where one fails."""
    here = (platform.system(), platform.machine())
    compiler = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
    chosen: dict[_Platform, list[str]] = {}
    if find_spec("ziglang") is not None:
        for each in _PLATFORMS.values():
            chosen[each] = [sys.executable, "-m", "ziglang", "cc", "-target", each.triple]
    if compiler is not None and here in _PLATFORMS and here[0] != "Windows":
        chosen[_PLATFORMS[here]] = [compiler]
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        for file, content in sources.items():
            (Path(folder) / file).write_bytes(content)
        units = [file for file in sources if file.endswith(".c")]
        for each, command in chosen.items():
            library = f"{name}{each.suffix}"
            found[f"binaries/{each.folders[version == '2.0']}/{library}"] = _compiled(folder, command, units, library)
    return found


def _compiled(folder: str, command: list[str], units: list[str], library: str) -> bytes:
    flags = _FLAGS if library.endswith(".so") else [flag for flag in _FLAGS if not flag.startswith("-Wl")]
    done = subprocess.run(  # noqa: S603 -- a compiler, on files that were written here
        [*command, *flags, "-o", library, *units, *([] if library.endswith(".dll") else ["-lm"])],
        cwd=folder, capture_output=True, text=True, timeout=_SECONDS, check=False,
    )  # fmt: skip
    if done.returncode:
        raise RuntimeError(f"{command[0]} could not compile {library}: {done.stderr[-2000:]}")
    return (Path(folder) / library).read_bytes()
