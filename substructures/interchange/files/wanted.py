"""What can be asked of a file that is to become a part: known without what reads it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from substructures.errors import InvalidDocument

KINDS = ("urdf", "mjcf", "sdf", "usd", "dh", "par")
Parameters = Literal["none", "inertia", "all"]
Fixed = Literal["ports", "bodies", "dropped"]
Base = Literal["fixed", "floating"]
Rotations = Literal["angles", "quaternions"]


@dataclass(frozen=True)
class Options:
    """How a file becomes a part.

    ``parameters``: which numbers become named parameters with the file's values as defaults; ``fixed``: what links on
    fixed joints become besides being merged: ``ports``, ``bodies`` of their own instead, or nothing; ``base``: whether
    the root link may move freely; ``rotations``: with what ball and free joints turn.
    """

    parameters: Parameters = "inertia"
    fixed: Fixed = "ports"
    base: Base = "fixed"
    rotations: Rotations = "angles"


def text_of_file(given: Mapping[str, Any]) -> bytes:
    """The bytes of ``{"file": text, "kind": ...}``. Raises InvalidDocument."""
    if set(given) - {"file", "kind"} or not isinstance(given["file"], str):
        raise InvalidDocument.at("/file", "file-expected", "a file is its text, and perhaps its kind")
    return given["file"].encode("utf-8", "replace")
