"""The catalogue of one server: parts, their versions, names and formulas."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from substructures.client.answers import Answer, Drawn, Page
from substructures.client.connection import query
from substructures.client.drawings import PictureCaller
from substructures.client.problems import ProblemError
from substructures.client.steps import Referable, step
from substructures.display import Formula, Picture
from substructures.documents import read_json


class Version(Drawn):
    """A version of a part; notebooks show its picture."""

    name: str
    version: int
    digest: str
    title: str
    description: str
    dof: int
    joints: str
    tags: list[str]
    coordinates: list[str]
    bodies: list[str]
    ports: list[str]
    parameters: dict[str, dict[str, Any]]
    operations: dict[str, int]
    certificate: dict[str, Any]
    warnings: list[dict[str, Any]]
    aliases: list[str]
    is_withdrawn: bool
    owner: str
    visibility: str

    def __repr__(self) -> str:
        joints = f", joints {self['joints']}" if self.get("joints") else ""
        return f"Version {self.ref}: {self.get('title') or 'no title'}{joints}"

    @property
    def ref(self) -> str:
        """Name and version."""
        return f"{self['name']}@{self['version']}"


class CatalogueCaller(PictureCaller):
    """What can be done with parts; ``ref`` is a reference (``acrobot``, ``acrobot@3``) or a Version."""

    def version_of(self, told: Mapping[str, Any]) -> Version:
        """An answer about a version as such."""
        found = Version(told, lambda q: self.part_picture(found, q))
        return found

    def submit(self, definition: Any) -> tuple[Version, bool]:
        """Submit a definition: the version, and whether it is new."""
        answer = self.request("POST", "/v1/substructures", definition)
        if answer.status_code == 202:
            return self.version_of(self._made_by_job(answer.json()["id"])), True
        return self.version_of(answer.json()), answer.status_code == 201

    def substructure(self, ref: str | Referable) -> Version:
        """A version of the catalogue."""
        return self.version_of(self.told("GET", f"/v1/substructures/{step(ref)}"))

    def substructures(self, **filters: Any) -> Iterator[Version]:
        """The latest versions of all parts that fit: ``q`` (words), ``tag`` (one or a list), ``dof_min``, ``dof_max``,
        ``joints``, ``owner``, ``sort``; pages are asked for as they are needed.
        """
        return self._pages("/v1/substructures", filters, self.version_of)

    def search(self, **filters: Any) -> Page[Version]:
        """One page of :meth:`substructures`, also with ``facets=True``, ``page_size`` and ``page_token``."""
        return self._page("/v1/substructures", filters, self.version_of)

    def definition(self, ref: str | Referable) -> dict[str, Any]:
        """The definition as stored, its numbers exact (integers and decimals)."""
        return dict(read_json(self.request("GET", f"/v1/substructures/{step(ref)}/definition").content))

    def versions(self, name: str) -> Iterator[Version]:
        """All versions of a part, the newest first: who made them, when, of what and why."""
        return self._pages(f"/v1/substructures/{step(name)}/versions", {}, self.version_of)

    def difference(self, a: str | Referable, b: str | Referable) -> Answer:
        """What changed from one version to another, also of two parts; ``words`` say it."""
        return self.told("GET", f"/v1/substructures/{step(a)}/difference" + query({"to": _ref(b)}))

    def uses(self, ref: str | Referable) -> Iterator[Answer]:
        """What is built of a part."""
        return self._pages(f"/v1/substructures/{step(ref)}/uses", {}, Answer)

    def levels(self, ref: str | Referable) -> list[Answer]:
        """The other levels of a part, full, reduced or abbreviated, with the errors of the shorter ones."""
        return [Answer(each) for each in self.told("GET", f"/v1/substructures/{step(ref)}/levels")["items"]]

    def withdraw(self, ref: str | Referable, reason: str = "", successor: str | None = None) -> Version:
        """Withdraw a version; ``successor``: what to take instead."""
        body = {"reason": reason} | ({} if successor is None else {"successor": successor})
        return self.version_of(self.told("POST", f"/v1/substructures/{step(ref)}/withdraw", body))

    def aliases(self, name: str) -> list[Answer]:
        """All aliases of a part with their history."""
        return [Answer(each) for each in self.told("GET", f"/v1/substructures/{step(name)}/aliases")["items"]]

    def alias(self, name: str, alias: str) -> Answer:
        """An alias with its history."""
        return self.told("GET", f"/v1/substructures/{step(name)}/aliases/{step(alias)}")

    def set_alias(self, name: str, alias: str, version: int) -> Answer:
        """Create an alias, or move it. Raises ProblemError 412 when somebody else moves it meanwhile."""
        path = f"/v1/substructures/{step(name)}/aliases/{step(alias)}"
        try:
            headers = {"If-Match": self.request("GET", path).headers["ETag"]}
        except ProblemError as error:
            if error.problem.get("code") != "unknown-alias":
                raise
            headers = {}
        return self.told("PUT", path, {"version": version}, headers=headers)

    def visibility(self, name: str) -> Answer:
        """``name, owner, visibility`` of a part."""
        return self.told("GET", f"/v1/substructures/{step(name)}/visibility")

    def set_visibility(self, name: str, visibility: str = "public") -> Answer:
        """Make all versions of a part public, for good."""
        return self.told("PUT", f"/v1/substructures/{step(name)}/visibility", {"visibility": visibility})

    def part_formulas(self, ref: str | Referable) -> Answer:
        """The index of all stored formulas of a part."""
        return self.told("GET", f"/v1/substructures/{step(ref)}/formulas")

    def part_formula(
        self,
        ref: str | Referable,
        quantity: str,
        format: str = "text",  # noqa: A002 -- the name in the contract
        **options: Any,
    ) -> Formula:
        """A quantity of a part as text in one of the formats; ``options``: ``form, bind, name, body, coordinate,
        component, inertia``.
        """
        return self._formula(f"/v1/substructures/{step(ref)}/formulas/{step(quantity)}", format, options)

    def part_report(self, ref: str | Referable, format: str = "json") -> str:  # noqa: A002 -- the name in the contract
        """What there is to be said of a part, with its formulas: ``json, text, latex`` or ``mathml``."""
        return self.request("GET", f"/v1/substructures/{step(ref)}/report", params={"format": format}).text

    def part_picture(self, ref: str | Referable, q: Sequence[float] | None = None) -> Picture:
        """SVG of a part, in the pose ``q`` or at home."""
        return self._picture(f"/v1/substructures/{step(ref)}", q)


def _ref(given: str | Referable) -> str:
    return given if isinstance(given, str) else given.ref
