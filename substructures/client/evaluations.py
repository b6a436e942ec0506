"""Numbers of trees of one server: evaluations, analyses and motions."""

from __future__ import annotations

import json
from collections.abc import Generator, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from substructures.client.answers import Answer
from substructures.client.jobs import JobCaller
from substructures.client.numbers import Evaluation, Motion, arrays_of, motion_of
from substructures.client.results import joined_parts
from substructures.client.steps import Referable, step
from substructures.formats import arrow
from substructures.formats.arrays import MEDIA_TYPE as NPZ
from substructures.formats.arrays import as_answer, flat, nested, view_npz, write_npz


class NumberCaller(JobCaller):
    """What can be computed of trees; ``tree`` is a reference or a Tree."""

    def evaluate(self, tree: str | Referable, **request: Any) -> Evaluation:
        """Numbers: ``quantities``, ``q``, ``qd``, ``parameters``, ... (the HTTP contract, section 4).

        When one of the values is a numpy array, all travel as npz, and arrays come back in place of lists; so they do
        where it takes so long that it becomes a job, which is waited for.
        """
        path, given = f"/v1/trees/{step(tree)}/evaluations", flat(request)
        if not _has_arrays(given):
            told = self.request("POST", path, request)
            found = self._whole(told.json()) if told.status_code == 202 else told.json()
            return Evaluation(found, request)
        status, content = self._exchange(path, write_npz(given), NPZ)
        found = self._whole(json.loads(bytes(content))) if status == 202 else as_answer(view_npz(content))
        return Evaluation(found, request)

    def _whole(self, job: Mapping[str, Any]) -> dict[str, Any]:
        """The answer of an evaluation that became a job, in one piece."""
        parts = list(self.results(job["id"]))
        found = parts[0] if len(parts) == 1 else joined_parts(parts)
        return {name: value for name, value in found.items() if name != "range"}

    def evaluate_batches(
        self, tree: str | Referable, batches: Iterable[Mapping[str, Any]], **constants: Any
    ) -> Generator[Evaluation, None, None]:
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
                yield Evaluation(nested(columns))

    def analyse(self, tree: str | Referable, analysis: str, **request: Any) -> Answer:
        """Numbers that follow from the equations of motion: ``linearisations``, ``equilibria``, ``root-loci``, ...

        When one of the values is a numpy array, arrays come back in place of lists.
        """
        if _has_arrays(flat(request)):
            return Answer(arrays_of(self.analysis(tree, analysis, request, NPZ)[0]))
        return Answer(json.loads(self.analysis(tree, analysis, request)[0]))

    def simulate(self, tree: str | Referable, **request: Any) -> Motion:
        """A motion with its checks; ``t``, ``q``, ``qd`` and ``series`` are arrays."""
        return motion_of(self.analysis(tree, "simulations", request, NPZ)[0])

    def analysis(
        self, tree: str | Referable, analysis: str, request: Any, media_type: str = "application/json"
    ) -> tuple[bytes, dict[str, Any]]:
        """The answer to a request for numbers in one of its media types, and ``status`` of a motion and
        ``is_right`` (None where that is not known).

        Waits where it takes so long that it becomes a job.
        """
        path, headers = f"/v1/trees/{step(tree)}/{analysis}", {"Accept": media_type}
        answer = self.request("POST", path, request, headers=headers)
        if answer.status_code != 202:
            told = {"status": answer.headers.get("trajectory-status", "finished")}
            right = answer.headers.get("trajectory-right")
            return answer.content, told | ({} if right is None else {"is_right": json.loads(right)})
        item = self._item_of_job(answer.json()["id"])
        return self.request("GET", item["files"][0]["href"]).content, item["result"]

    def compile_kernels(self, tree: str | Referable, quantities: Sequence[str]) -> Answer:
        """Compile ahead what evaluations of these quantities need."""
        return self.told("POST", f"/v1/trees/{step(tree)}/kernels", {"quantities": list(quantities)})


def _has_arrays(given: Mapping[str, Any]) -> bool:
    return any(isinstance(value, np.ndarray) for value in given.values())
