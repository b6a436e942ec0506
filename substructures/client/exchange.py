"""What leaves one server and what comes in: exports, robot files, comparisons, bundles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import httpx2

from substructures.client.answers import Answer
from substructures.client.connection import query
from substructures.client.jobs import JobCaller
from substructures.client.steps import Referable, step

FILE = {"Content-Type": "application/octet-stream"}
ZIP = {"Content-Type": "application/zip"}


class ExchangeCaller(JobCaller):
    """Models as files."""

    def export(
        self,
        kind: str,
        ref: str | Referable,
        target: str,
        quantities: Sequence[str] = (),
        name: str = "",
        bind: str = "",
        together: bool = False,
        packed: bool = False,
        fmi: str = "3.0",
        precision: str = "double",
        stages: bool = False,
    ) -> httpx2.Response:
        """The answer with the files of a target: of ``kind`` trees or substructures."""
        wanted = {
            "target": target,
            "quantities": ",".join(quantities),
            "name": name,
            "bind": bind,
            "together": together,
            "packed": packed,
            "fmi": fmi,
            "precision": precision,
            "stages": stages,
        }
        return self.request("GET", f"/v1/{step(kind)}/{step(ref)}/export" + query(wanted))

    def export_files(self, kind: str, ref: str | Referable, target: str, **options: Any) -> bytes:
        """The file of a target, or a zip of several, as :meth:`export`; waits where it becomes a job."""
        return self._content(self.export(kind, ref, target, **options))

    def import_file(self, content: bytes | Path, **options: Any) -> Answer:
        """A robot file as a definition, or as a tree, with a report; ``options``: ``kind, name, file, license,
        parameters, fixed, base, cut, store``.
        """
        if isinstance(content, Path):
            options, content = {"file": content.name, **options}, content.read_bytes()
        links = options.get("cut")
        options |= {"cut": ",".join(links)} if isinstance(links, list | tuple) else {}
        answer = self.request("POST", "/v1/imports" + query(options), content=content, headers=FILE)
        if answer.status_code != 202:
            return Answer(answer.json())
        made = self._made_by_job(answer.json()["id"])
        version = made.get("version", made.get("revision"))
        stored = {"name": made["name"], "version": version, "digest": made["digest"], "href": made["links"]["self"]}
        return Answer({**self.import_file(content, **{**options, "store": False}), "stored": stored})

    def compare(self, a: Any, b: Any, coordinates: Mapping[str, str] | None = None) -> Answer:
        """Whether two models are the same: references, definitions, trees, or ``{"file": text}``.

        ``coordinates``: names in ``a`` to names in ``b``, where they differ.
        """
        named = {} if coordinates is None else {"coordinates": dict(coordinates)}
        return self.told("POST", "/v1/equivalences", {"a": _model(a), "b": _model(b), **named})

    def bundle(self, refs: Sequence[str | Referable]) -> bytes:
        """Parts and trees with all that they are made of, as one zip file for another server."""
        names = ",".join(ref if isinstance(ref, str) else ref.ref for ref in refs)
        return self.request("GET", "/v1/bundles" + query({"refs": names})).content

    def import_bundle(self, content: bytes | Path) -> list[Answer]:
        """Store what is in a bundle: what became of each of its items."""
        data = content.read_bytes() if isinstance(content, Path) else content
        return [Answer(item) for item in self.told("POST", "/v1/bundles", content=data, headers=ZIP)["items"]]


def _model(given: Any) -> Any:
    """The reference of a version or tree; all else as it is."""
    return getattr(given, "ref", given)
