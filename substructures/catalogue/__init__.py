"""The shipped substructures: one YAML file each, in the format of a definition, with its source and licence.

>>> "puma560" in names()
True
>>> load("simple-pendulum")["bodies"][0]["mass"]
'm'
"""

from __future__ import annotations

from functools import cache
from importlib import resources
from typing import Any

from substructures.documents import read_yaml

_SUFFIX = ".yaml"


@cache
def names() -> tuple[str, ...]:
    """The names of all entries, sorted."""
    files = (entry.name for entry in resources.files(__name__).iterdir())
    return tuple(sorted(name.removesuffix(_SUFFIX) for name in files if name.endswith(_SUFFIX)))


def load(name: str) -> dict[str, Any]:
    """The definition of an entry as plain data (a new copy every time).

    Raises :class:`KeyError` for a name that is not in :func:`names`.
    """
    if name not in names():
        raise KeyError(f"no catalogue entry '{name}'; there are: {', '.join(names())}")
    data = resources.files(__name__).joinpath(name + _SUFFIX).read_bytes()
    definition: dict[str, Any] = read_yaml(data)
    return definition
