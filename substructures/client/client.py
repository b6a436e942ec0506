"""A small typed client of the HTTP interface."""

from __future__ import annotations

import json
from collections.abc import Generator, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from substructures.client.bulk import read_all
from substructures.client.connection import ProblemError, step
from substructures.client.jobs import JobCaller, ServerLost, joined_parts
from substructures.formats import arrow
from substructures.formats.arrays import MEDIA_TYPE as NPZ
from substructures.formats.arrays import as_answer, flat, nested, view_npz, write_npz

__all__ = ["Client", "ProblemError", "ServerLost"]


class Client(JobCaller):
    """Talks to one server. All methods raise ProblemError, and httpx2.HTTPError when there is no answer."""

    def submit(self, definition: Any) -> tuple[dict[str, Any], bool]:
        """Submit a definition: the version, and whether it is new."""
        answer = self.request("POST", "/v1/substructures", definition)
        if answer.status_code == 202:
            return self._made_by_job(answer.json()["id"]), True
        return dict(answer.json()), answer.status_code == 201

    def substructure(self, ref: str) -> dict[str, Any]:
        """A version of the catalogue."""
        return dict(self.request("GET", f"/v1/substructures/{step(ref)}").json())

    def create_tree(self, spec: Any) -> dict[str, Any]:
        """Couple the instances of a tree."""
        return self._made("/v1/trees", spec)

    def couple(self, tree: str, instance: Any) -> dict[str, Any]:
        """Couple one more instance onto a tree; the new revision."""
        return self._made(f"/v1/trees/{step(tree)}/couplings", instance)

    def load(self, tree: str, load: Any) -> dict[str, Any]:
        """Let one more load act between frames of a tree; the new revision."""
        return self._made(f"/v1/trees/{step(tree)}/loads", load)

    def formula(
        self,
        tree: str,
        quantity: str,
        format: str = "text",  # noqa: A002 -- the name in the contract
        form: str = "readable",
        bind: str = "",
        **options: str | list[str],
    ) -> str:
        """A quantity of a tree as text in one of the formats; ``options``: of first_integrals, state_space, ..., and
        ``group="true"`` for formulas in base parameters.
        """
        wanted = {"format": format, "form": form, "bind": bind, **options}
        return self.request("GET", f"/v1/trees/{step(tree)}/{step(quantity)}", params=wanted).text

    def export(
        self,
        kind: str,
        ref: str,
        target: str,
        quantities: Sequence[str] = (),
        name: str = "",
        bind: str = "",
        together: bool = False,
        packed: bool = False,
        fmi: str = "3.0",
        precision: str = "double",
        stages: bool = False,
    ) -> Any:
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
        return self.request("GET", f"/v1/{step(kind)}/{step(ref)}/export", params=wanted)

    def evaluate(self, tree: str, **request: Any) -> dict[str, Any]:
        """Numbers: ``quantities``, ``q``, ``qd``, ``parameters``, ... (the HTTP contract, section 4).

        When one of the values is a numpy array, all travel as npz, and arrays come back in place of lists; so they do
        where it takes so long that it becomes a job, which is waited for.
        """
        path = f"/v1/trees/{step(tree)}/evaluations"
        given = flat(request)
        if not any(isinstance(value, np.ndarray) for value in given.values()):
            told = self.request("POST", path, request)
            return self._whole(told.json()) if told.status_code == 202 else dict(told.json())
        with self._transfer(path, write_npz(given), NPZ) as answer:
            content = read_all(answer)
        return self._whole(json.loads(bytes(content))) if answer.status == 202 else as_answer(view_npz(content))

    def _whole(self, job: Mapping[str, Any]) -> dict[str, Any]:
        """The answer of an evaluation that became a job, in one piece."""
        parts = list(self.results(job["id"]))
        found = parts[0] if len(parts) == 1 else joined_parts(parts)
        return {name: value for name, value in found.items() if name != "range"}

    def analyse(self, tree: str, analysis: str, **request: Any) -> dict[str, Any]:
        """Numbers that follow from the equations of motion: ``linearisations``, ``equilibria``, ``root-loci``, ..."""
        return dict(json.loads(self.analysis(tree, analysis, request)[0]))

    def simulate(self, tree: str, **request: Any) -> dict[str, Any]:
        """A motion with its checks; ``t``, ``q``, ``qd`` and ``series`` are arrays."""
        content, _ = self.analysis(tree, "simulations", request, NPZ)
        found = nested(view_npz(np.frombuffer(content, np.uint8)))
        return {**json.loads(str(found.pop("summary"))), **found}

    def analysis(
        self, tree: str, analysis: str, request: Any, media_type: str = "application/json"
    ) -> tuple[bytes, dict[str, Any]]:
        """The answer to a request for numbers in one of its media types, and ``status`` of a motion and
        ``is_right`` (None where that is not known).

        Waits where it takes so long that it becomes a job.
        """
        plain = {name: x.tolist() if isinstance(x, np.ndarray) else x for name, x in request.items()}
        path, headers = f"/v1/trees/{step(tree)}/{analysis}", {"Accept": media_type}
        answer = self.request("POST", path, plain, headers=headers)
        if answer.status_code != 202:
            told = {"status": answer.headers.get("trajectory-status", "finished")}
            right = answer.headers.get("trajectory-right")
            return answer.content, told | ({} if right is None else {"is_right": json.loads(right)})
        item = self._item_of_job(answer.json()["id"])
        return self.request("GET", item["files"][0]["href"]).content, item["result"]

    def evaluate_batches(
        self, tree: str, batches: Iterable[Mapping[str, Any]], **constants: Any
    ) -> Generator[dict[str, Any], None, None]:
        """Numbers for any number of states, in bounded memory; needs pyarrow.

        ``batches``: arrays by name (``q``, ``qd``, ``inputs``, ...) with one row for each state; ``constants``: what is
        the same for all (``quantities``, ``parameters``, ...). Gives the answer in parts, in order, NaN where a state
        has no result. Nothing is answered before all was sent.
        """
        tables = (arrow.ArrowTable(flat(batch)) for batch in batches)
        content = arrow.write_tables(tables, constants)
        with self._transfer(f"/v1/trees/{step(tree)}/evaluations", content, arrow.MEDIA_TYPE) as answer:
            if answer.status == 202:
                yield from self.results(json.loads(answer.read())["id"])
                return
            for columns in arrow.read_tables(answer):
                yield nested(columns)

    def _made(self, path: str, body: Any) -> dict[str, Any]:
        answer = self.request("POST", path, body)
        return self._made_by_job(answer.json()["id"]) if answer.status_code == 202 else dict(answer.json())

    def _made_by_job(self, job: str) -> dict[str, Any]:
        """What a request has made that took so long that it became a job of one item."""
        return dict(self.request("GET", self._item_of_job(job)["result"]["location"]).json())
