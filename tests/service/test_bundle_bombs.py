"""Bundles that are small and ask for much: they are refused while they are read."""

from __future__ import annotations

from time import process_time
from typing import Any

import pytest
from fastapi.testclient import TestClient

from .test_bundles import Files, changed_program, files, packed, sent, source

__all__ = ["files", "source"]


def powers(count: int, needed: bool) -> Any:
    """What puts so many powers of powers into a program; ``needed``: by one more output."""

    def change(program: Any) -> None:
        operations = program["operations"]
        symbol = next(i for i, operation in enumerate(operations) if operation[0] == "sym")
        start = len(operations)
        operations += [["powi", start + k - 1 if k else symbol, 64] for k in range(count)]
        if needed:
            last = {"shape": [], "symmetry": "none", "index": [[]], "entries": [len(operations) - 1]}
            program["outputs"]["more"] = last

    return change


REFUSALS = [(False, "no output needs it"), (True, "an exponent of more than 4096 bits")]


@pytest.mark.parametrize(("needed", "why"), REFUSALS)
def test_99000_powers(client: TestClient, files: Files, needed: bool, why: str) -> None:
    data = packed(changed_program(files, powers(99_000, needed)), 8)  # deflated
    assert len(data) < 500_000
    start = process_time()
    answer = sent(client, data)
    assert process_time() - start < 10  # what they ask for would take minutes, and gigabytes
    assert (answer.status_code, answer.json()["code"]) == (422, "invalid-bundle"), answer.text
    assert why in answer.json()["detail"]
    assert client.get("/v1/substructures/pendulum").status_code == 404
