"""Addresses of resources."""

from __future__ import annotations

from typing import Protocol

BASE = "/v1"


class Version(Protocol):
    """A part by its number."""

    @property
    def name(self) -> str:
        """Of all versions."""

    @property
    def version(self) -> int:
        """From 1."""


class Tree(Protocol):
    """A tree by its number."""

    @property
    def name(self) -> str:
        """Of all revisions."""

    @property
    def revision(self) -> int:
        """From 1."""


def version_path(version: Version) -> str:
    """The address of a version."""
    return f"{BASE}/substructures/{version.name}@{version.version}"


def tree_path(tree: Tree) -> str:
    """The address of a revision."""
    return f"{BASE}/trees/{tree.name}@{tree.revision}"
