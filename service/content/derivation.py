"""What is stored of documents, derived from them alone: pure functions of bytes, and which software does it.

A store never believes formulas that come with a document. It holds what these functions made of it, with the name of
the software that did (:func:`software`); what another version made is made anew.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from functools import lru_cache
from importlib.resources import files
from importlib.resources.abc import Traversable
from typing import Any

from substructures.documents import read_json, write_json
from substructures.part.definition import Definition
from substructures.part.derive import derive
from substructures.part.part import MAX_NODES, Part
from substructures.tree.document import TreeSpec, with_levels
from substructures.tree.publishing.published import Publication, published
from substructures.tree.publishing.published_formulas import published_part

#: packages of the science that formulas and certificates come from
SOURCES = ("certificate", "documents", "expr", "mechanics", "part", "tree")
NAMED = 16  # characters


@lru_cache(maxsize=1)
def software() -> str:
    """The name of the software that derives here: a digest of its source, so that no two versions share it."""
    return _named({package: files("substructures") / package for package in SOURCES})


@lru_cache(maxsize=1)
def release() -> str:
    """The name of the software that computes and writes results here, as :func:`software`."""
    return _named({package: files(package) for package in ("substructures", "service")}, (".py", ".c", ".h", ".mjs"))


def _named(packages: Mapping[str, Traversable], endings: tuple[str, ...] = (".py",)) -> str:
    found = hashlib.sha256()
    for package, folder in packages.items():
        for name, text in _modules(folder, package, endings):
            found.update(f"{name}\n{len(text)}\n".encode() + text)
    return found.hexdigest()[:NAMED]


def _modules(folder: Traversable, path: str, endings: tuple[str, ...]) -> list[tuple[str, bytes]]:
    found: list[tuple[str, bytes]] = []
    for each in sorted(folder.iterdir(), key=lambda each: each.name):
        name = f"{path}/{each.name}"
        if each.is_dir():
            found += _modules(each, name, endings)
        elif each.name.endswith(endings):
            found.append((name, each.read_bytes()))
    return found


def derived_part(definition: bytes, recipe: str | None = None, max_nodes: int = MAX_NODES) -> Part:
    """The part of a stored definition. ``recipe``: of a part that is a published tree (:func:`recipe_of`).

    Raises as :func:`substructures.part.derive.derive`.
    """
    wanted = Definition.stored(read_json(definition))
    found = None if recipe is None else _published(wanted, read_json(recipe.encode()), max_nodes)
    return derive(wanted, max_nodes, is_stored=True) if found is None else found


def _published(wanted: Definition, recipe: Mapping[str, Any], max_nodes: int) -> Part | None:
    """The part coupled of its instances; None where the recipe is that of another definition."""
    parts = {
        name: derived_part(write_json(each["definition"]), each.get("recipe"), max_nodes)
        for name, each in recipe["parts"].items()
    }
    spec = with_levels(TreeSpec.stored(recipe["tree"]), {name: part.definition for name, part in parts.items()})
    how = Publication(recipe["about"], recipe["ports"], tuple(recipe["free"]), recipe["defaults"])
    found = published(spec, parts, how)
    return published_part(found, parts, max_nodes) if found.definition.digest == wanted.digest else None


def recipe_of(spec: TreeSpec, parts: Mapping[str, Part], recipes: Mapping[str, str | None], how: Publication) -> str:
    """All that the formulas of a published tree follow from: its document, the definitions of its instances (with their
    ``recipes``, where these are published trees themselves), and what was asked for.
    """
    told = {
        name: {"definition": read_json(part.definition.canonical()), "recipe": recipes.get(name)}
        for name, part in parts.items()
    }
    ports = None if how.ports is None else dict(how.ports)
    asked = {"about": dict(how.about), "ports": ports, "free": list(how.free), "defaults": dict(how.defaults)}
    return write_json({"tree": read_json(spec.canonical()), "parts": told, **asked}).decode()
