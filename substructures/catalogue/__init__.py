"""The shipped substructures: one YAML file each, in the format of a definition, with its source and licence.

>>> "puma560" in names()
True
>>> load("simple-pendulum")["bodies"][0]["mass"]
'm'
"""

from __future__ import annotations

import json
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


def digests() -> dict[str, str]:
    """The digest of the definition of every entry by name: what is stored of them is found without reading them.

    It stands beside the entries; a test holds it against them.
    """
    found: dict[str, str] = json.loads(resources.files(__name__).joinpath("digests.json").read_bytes())
    return found


def load(name: str) -> dict[str, Any]:
    """The definition of an entry as plain data (a new copy every time).

    Raises :class:`KeyError` for a name that is not in :func:`names`.
    """
    if name not in names():
        raise KeyError(f"no catalogue entry '{name}'; there are: {', '.join(names())}")
    return _read(name + _SUFFIX)


def load_tree(name: str) -> dict[str, Any]:
    """A shipped tree of entries as plain data: ``humanoid``, 34 degrees of freedom in seven parts, and
    ``humanoid-floating``, the same on a base without singular angles.

    Raises :class:`FileNotFoundError` for another name.
    """
    return _read("trees", name + _SUFFIX)


def _read(*path: str) -> dict[str, Any]:
    data: dict[str, Any] = read_yaml(resources.files(__name__).joinpath(*path).read_bytes(), is_ours=True)
    return data
