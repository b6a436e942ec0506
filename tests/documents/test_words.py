"""Texts for people: what nobody sees in them is refused where they are given, and read where it was stored."""

from __future__ import annotations

from typing import Any

import pytest

from substructures import Definition
from substructures.errors import InvalidDocument

PLAIN: dict[str, Any] = {"name": "a", "bodies": [{"name": "b", "parent": "base", "joint": {"type": "fixed"}}]}
FIELDS = ("title", "description", "license", "source")


@pytest.mark.parametrize("hidden", ["\0", "\x1b", "\x7f", "\x85", "\u202e", "\u2066", "\u2069"])
@pytest.mark.parametrize("field", FIELDS)
def test_controls_are_refused(field: str, hidden: str) -> None:
    document = {**PLAIN, field: f"ab{hidden}c"}
    with pytest.raises(InvalidDocument, match=f"character 3 is U\\+{ord(hidden):04X}, a control") as caught:
        Definition.read(document)
    assert [(fault.pointer, fault.code) for fault in caught.value.faults] == [(f"/{field}", "control-character")]
    assert getattr(Definition.stored(document), field) == f"ab{hidden}c"


def test_descriptions_of_parameters_and_inputs() -> None:
    for kind in ("parameters", "inputs"):
        with pytest.raises(InvalidDocument) as caught:
            Definition.read({**PLAIN, kind: {"m": {"description": "mass\u202e"}}})
        assert caught.value.faults[0].pointer == f"/{kind}/m/description"


def test_other_texts_are_what_they_are() -> None:
    text = "two\tcolumns\r\nG\u00e9n\u00e9rateur \u05d0\u200f \u4e2d\u6587 \U0001f4a3"
    assert Definition.read({**PLAIN, "description": text}).description == text
