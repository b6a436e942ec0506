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
        ranges: str = "",
        stages: bool = False,
        standard: str = "c99",
        independent: Sequence[str] = (),
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
            "ranges": ranges,
            "stages": stages,
            "standard": standard,
            "independent": ",".join(independent),
        }
        return self.request("GET", f"/v1/{step(kind)}/{step(ref)}/export" + query(wanted))

    def export_files(self, kind: str, ref: str | Referable, target: str, **options: Any) -> bytes:
        """The file of a target, or a zip of several, as :meth:`export`; waits where it becomes a job."""
        return self.content_of(self.export(kind, ref, target, **options))

    def module(self, kind: str, ref: str | Referable, quantities: Sequence[str] = ()) -> bytes:
        """Quantities of one of ``trees`` or ``substructures`` as a module of WebAssembly."""
        names = query({"quantities": ",".join(quantities) or None})
        return self.request("GET", f"/v1/{kind}/{step(ref)}/program.wasm{names}").content

    def module_layout(self, kind: str, ref: str | Referable, quantities: Sequence[str] = ()) -> Answer:
        """What stands where in the memory of a module, and how its functions are called."""
        names = query({"quantities": ",".join(quantities) or None})
        return self.told("GET", f"/v1/{kind}/{step(ref)}/program.json{names}")

    def origins(self, kind: str, ref: str | Referable) -> Answer:
        """The bodies and symbols that every entry of metric, Christoffel symbols and forces comes from."""
        return self.told("GET", f"/v1/{kind}/{step(ref)}/origins")

    def scene(self, kind: str, ref: str | Referable) -> Answer:
        """What there is to draw: ``frames, joints, bodies, loads, closures, gravity, sphere, poses``."""
        return self.told("GET", f"/v1/{kind}/{step(ref)}/scene")

    def import_file(self, content: bytes | Path, **options: Any) -> Answer:
        """A robot file, or a zip of one with its meshes, as a definition or a tree, with a report; ``options``: ``kind,
        name, file, license, parameters, fixed, base, rotations, cut, preview, store``.
        """
        if isinstance(content, Path):
            options, content = {"file": content.name, **options}, content.read_bytes()
        links = options.get("cut")
        options |= {"cut": ",".join(links)} if isinstance(links, list | tuple) else {}
        headers = ZIP if content.startswith(b"PK\x03\x04") else FILE
        answer = self.request("POST", "/v1/imports" + query(options), content=content, headers=headers)
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
