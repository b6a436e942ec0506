"""Addresses of resources."""

from __future__ import annotations

from service.queries.catalogue import Version
from service.queries.trees import Tree

BASE = "/v1"


def version_path(version: Version) -> str:
    """The address of a version."""
    return f"{BASE}/substructures/{version.name}@{version.version}"


def tree_path(tree: Tree) -> str:
    """The address of a revision."""
    return f"{BASE}/trees/{tree.name}@{tree.revision}"
