"""Trees of one server: coupled, changed by a revision each, compared, and published as parts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from substructures.client.answers import Answer, Drawn
from substructures.client.catalogue import CatalogueCaller, Version
from substructures.client.connection import query
from substructures.client.steps import Referable, step
from substructures.display import Formula, Picture


class Tree(Drawn):
    """A revision of a tree; notebooks show its picture."""

    name: str
    revision: int
    digest: str
    dof: int
    coordinates: list[str]
    joints: str
    frames: list[str]
    parameters: dict[str, dict[str, Any]]
    inputs: dict[str, Any]
    instances: list[dict[str, Any]]
    operations: dict[str, int]
    certificate: dict[str, Any]
    warnings: list[dict[str, Any]]
    owner: str
    visibility: str

    def __repr__(self) -> str:
        names = f": {', '.join(self['coordinates'])}" if self.get("coordinates") else ""
        return f"Tree {self.ref}{names}"

    @property
    def ref(self) -> str:
        """Name and revision."""
        return f"{self['name']}@{self['revision']}"


class TreeCaller(CatalogueCaller):
    """What can be done with trees; ``tree`` is a reference (``cell``, ``cell@2``) or a Tree."""

    def tree_of(self, told: Mapping[str, Any]) -> Tree:
        """An answer about a tree as such."""
        found = Tree(told, lambda q: self.tree_picture(found, q))
        return found

    def create_tree(self, spec: Any) -> Tree:
        """Couple the instances of a tree."""
        return self.tree_of(self._made("POST", "/v1/trees", spec))

    def tree(self, ref: str | Referable) -> Tree:
        """A revision of a tree."""
        return self.tree_of(self.told("GET", f"/v1/trees/{step(ref)}"))

    def trees(self, **filters: Any) -> Iterator[Tree]:
        """The latest revisions of all trees that fit: ``q`` (words in the name), ``uses`` (a part), ``owner``."""
        return self._pages("/v1/trees", filters, self.tree_of)

    def revisions(self, name: str) -> Iterator[Tree]:
        """All revisions of a tree, the newest first."""
        return self._pages(f"/v1/trees/{step(name)}/revisions", {}, self.tree_of)

    def remove_tree(self, name: str) -> None:
        """Remove a tree with all its revisions; its parts stay."""
        self.request("DELETE", f"/v1/trees/{step(name)}")

    def couple(self, tree: str | Referable, instance: Any) -> Tree:
        """Couple one more instance onto a tree; the new revision. Of a Tree it is that revision which is changed."""
        return self.tree_of(self._made("POST", f"/v1/trees/{step(tree)}/couplings", instance))

    def change_coupling(self, tree: str | Referable, instance: str, **members: Any) -> Tree:
        """Give an instance other members (``substructure``, ``at``, ``placement``, ``parameters``), None leaves one
        out; what it carries stays on it; the new revision."""
        return self.tree_of(self._made("PATCH", f"/v1/trees/{step(tree)}/couplings/{step(instance)}", members))

    def change_tree(self, tree: str | Referable, **members: Any) -> Tree:
        """Give a tree other members (``gravity``, ``parameters``, ``inputs``, ``driven``, ``ignored``,
        ``velocity_constraints``, ``contacts``), None leaves one out; the new revision."""
        return self.tree_of(self._made("PATCH", f"/v1/trees/{step(tree)}", members))

    def uncouple(self, tree: str | Referable, instance: str) -> Tree:
        """Take an instance off a tree; the new revision."""
        return self.tree_of(self._made("DELETE", f"/v1/trees/{step(tree)}/couplings/{step(instance)}"))

    def load(self, tree: str | Referable, load: Any) -> Tree:
        """Let one more load act between frames of a tree; the new revision."""
        return self.tree_of(self._made("POST", f"/v1/trees/{step(tree)}/loads", load))

    def unload(self, tree: str | Referable, load: str) -> Tree:
        """Let a load act no more; the new revision."""
        return self.tree_of(self._made("DELETE", f"/v1/trees/{step(tree)}/loads/{step(load)}"))

    def close_loop(self, tree: str | Referable, closure: Any) -> Tree:
        """Close one more loop of a tree; the new revision."""
        return self.tree_of(self._made("POST", f"/v1/trees/{step(tree)}/closures", closure))

    def open_loop(self, tree: str | Referable, closure: str) -> Tree:
        """Cut a loop of a tree open; the new revision."""
        return self.tree_of(self._made("DELETE", f"/v1/trees/{step(tree)}/closures/{step(closure)}"))

    def tree_difference(self, a: str | Referable, b: str | Referable) -> Answer:
        """What changed from one revision to another, also of two trees; ``words`` say it."""
        to = b if isinstance(b, str) else b.ref
        return self.told("GET", f"/v1/trees/{step(a)}/difference" + query({"to": to}))

    def publish(self, tree: str | Referable, **request: Any) -> Version:
        """Make a part of a tree: ``name, title, ports, free, defaults, note, ...`` of the part."""
        return self.version_of(self._made("POST", f"/v1/trees/{step(tree)}/publish", request))

    def tree_visibility(self, name: str) -> Answer:
        """``name, owner, visibility`` of a tree."""
        return self.told("GET", f"/v1/trees/{step(name)}/visibility")

    def set_tree_visibility(self, name: str, visibility: str = "public") -> Answer:
        """Make all revisions of a tree public, for good."""
        return self.told("PUT", f"/v1/trees/{step(name)}/visibility", {"visibility": visibility})

    def report(self, tree: str | Referable, format: str = "json") -> str:  # noqa: A002 -- the name in the contract
        """What there is to be said of a tree, with its formulas: ``json, text, latex`` or ``mathml``."""
        return self.request("GET", f"/v1/trees/{step(tree)}/report", params={"format": format}).text

    def tree_picture(self, tree: str | Referable, q: Sequence[float] | None = None) -> Picture:
        """SVG of a tree, in the pose ``q`` or at home."""
        return self._picture(f"/v1/trees/{step(tree)}", q)

    def formula(
        self,
        tree: str | Referable,
        quantity: str,
        format: str = "text",  # noqa: A002 -- the name in the contract
        form: str = "readable",
        bind: str = "",
        **options: Any,
    ) -> Formula:
        """A quantity of a tree as text in one of the formats; ``options``: of first_integrals, state_space, ..."""
        path = f"/v1/trees/{step(tree)}/{step(quantity)}"
        return self._formula(path, format, {"form": form, "bind": bind, **options})

    def velocity_equations(
        self,
        tree: str | Referable,
        request: Any,
        format: str = "text",  # noqa: A002 -- the name in the contract
        **options: Any,
    ) -> Formula:
        """Voronets' and Boltzmann-Hamel equations for the ``constraints`` of a request; ``options``: ``form, bind``."""
        return self._formula(f"/v1/trees/{step(tree)}/velocity-equations", format, options, "POST", request)
