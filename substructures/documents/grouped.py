"""Flat documents and typed arguments: requests and items of jobs have one level, functions take a few frozen values."""

from __future__ import annotations

from dataclasses import fields
from typing import Any, TypeVar

Made = TypeVar("Made")


def take(made: type[Made], given: dict[str, Any]) -> Made:
    """The value that the fields of its class make; they are taken out of what is ``given`` by name."""
    names = [field.name for field in fields(made) if field.name in given]  # type: ignore[arg-type]
    return made(**{name: given.pop(name) for name in names})
