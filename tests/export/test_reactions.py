"""Reactions as functions on the calling convention: with a closure its multipliers are the further argument x."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from catalogue_entries import shipped_part
from exported_models import LIMIT
from run_code import STRICT, tool

from substructures import TreeSpec, couple
from substructures.export import exported_model, files, interface_of_model
from substructures.quantities.reactions import reactions
from substructures.quantities.sources import Sources

COMMANDS = {
    "python": [[sys.executable, "crank_selftest.py"]],
    "c": [["gcc", *STRICT, "-o", "run", "crank_selftest.c", "crank.c", "-lm"], ["./run"]],
}


@pytest.mark.parametrize("target", COMMANDS)
def test_functions_pass_their_self_tests(target: str, tmp_path: Path) -> None:
    wrist = {"name": "wrist", "type": "pin", "from": "x.rod_end", "to": "x.pin"}
    one = {"name": "x", "substructure": "slider-crank"}
    spec = TreeSpec.read({"name": "loop", "gravity": [0, 0, "-9.81"], "instances": [one], "closures": [wrist]})
    parts = {"x": shipped_part("slider-crank")}
    model = couple(spec, parts)
    transmitted = reactions(spec, parts)
    sources = Sources(model, of_parts=lambda _: transmitted)
    exported = exported_model(sources, interface_of_model(model, "loop@1", "sha256:1"), ["reactions"], "crank")
    (function,) = exported.functions
    assert function.arguments == ("q", "qd", "qdd", "u", "x", "p")
    assert function.further.names == tuple(f"lambda.wrist.{row}" for row in ("rx", "ry", "x", "y", "z"))
    for name, data in files(exported, target, LIMIT).items():
        (tmp_path / name).write_bytes(data)
    for command in COMMANDS[target]:
        program = command[0] if command[0].startswith((".", "/")) else tool(command[0])
        done = subprocess.run([program, *command[1:]], cwd=tmp_path, capture_output=True, text=True, timeout=60)
        assert done.returncode == 0, done.stdout + done.stderr
