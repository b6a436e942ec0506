"""Jobs of one server: submit, watch, read results, also of states that are uploaded."""

from __future__ import annotations

import io
import json
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from time import monotonic, sleep
from typing import Any

import httpx2
import numpy as np

from substructures.client.connection import Caller, ProblemError, check, step
from substructures.formats import arrow
from substructures.formats.arrays import MEDIA_TYPE as NPZ
from substructures.formats.arrays import Npz, as_answer, flat, nested, placed, view_npz, write_npz
from substructures.formats.columns import parted, request_of

#: seconds between looks at a job, for one look, and without an answer
PERIOD, LOOK, PATIENCE = 0.5, 5.0, 60.0
GATEWAY = (502, 503, 504)  # what stands before a server, or its database, that is gone for a while
AT_ONCE = 2**25  # bytes of states that are sent as npz, and in one batch of an Arrow stream
FORMATS = {"npz": NPZ, "arrow": arrow.MEDIA_TYPE}


class ServerLost(httpx2.TransportError):
    """The server has not answered for too long."""


class JobCaller(Caller):
    """What can be done with jobs."""

    def submit_job(self, submission: Any) -> dict[str, Any]:
        """Queue ``{"kind", "items"}`` or ``{"kind", "template", "choices"}``: the job."""
        return dict(self.request("POST", "/v1/jobs", submission).json())

    def job(self, job: str) -> dict[str, Any]:
        """A job with its progress."""
        return dict(self.request("GET", f"/v1/jobs/{step(job)}").json())

    def jobs(self, **filters: str) -> Iterator[dict[str, Any]]:
        """All jobs (of a ``state``, of a ``kind``), the newest first."""
        return self._pages("/v1/jobs", filters)

    def job_items(self, job: str, **filters: str) -> Iterator[dict[str, Any]]:
        """The items of a job (in a ``state``) with their results and problems."""
        return self._pages(f"/v1/jobs/{step(job)}/items", filters)

    def cancel_job(self, job: str) -> dict[str, Any]:
        """Cancel what is not finished."""
        return dict(self.request("POST", f"/v1/jobs/{step(job)}/cancel").json())

    def retry_job(self, job: str) -> dict[str, Any]:
        """What of a job failed or was cancelled once more: the new job."""
        return dict(self.request("POST", f"/v1/jobs/{step(job)}/retry").json())

    def remove_job(self, job: str) -> None:
        """Remove a job that has ended, with its results."""
        self.request("DELETE", f"/v1/jobs/{step(job)}")

    def submit_states(
        self, tree: str, states: Mapping[str, Any] | Iterable[Mapping[str, Any]], form: str = "npz", **constants: Any
    ) -> dict[str, Any]:
        """Queue the evaluation of a tree for many states: the job, when all states are on the disk of the server.

        ``states``: arrays or lists by name (``q``, ``qd``, ...), or batches of arrays as for ``evaluate_batches``;
        ``constants``: what is the same for all (``quantities``, ``parameters``, ...); ``form``: npz or arrow, of the
        results. More than 32 MiB, and batches, travel as an Arrow stream, which needs pyarrow.
        """
        path, headers = f"/v1/trees/{step(tree)}/evaluations", {"Prefer": "respond-async", "Accept": FORMATS[form]}
        if isinstance(states, Mapping):
            if not any(isinstance(x, np.ndarray) for x in flat(states).values()):
                return dict(self.request("POST", path, {**states, **constants}, headers=headers).json())
            rows, rest = parted(flat(states))
            size = sum(x.nbytes for x in rows.values())
            if size <= AT_ONCE:
                return self._queued(path, write_npz({**rows, **rest, **flat(constants)}), NPZ, headers)
            plain = {name: x.tolist() if isinstance(x, np.ndarray) else x for name, x in rest.items()}
            constants = request_of({}, {**plain, **flat(constants)})
            states = _batches(rows, size)
        tables = (arrow.ArrowTable(flat(batch)) for batch in states)
        return self._queued(path, arrow.write_tables(tables, constants), arrow.MEDIA_TYPE, headers)

    def _queued(
        self, path: str, content: Npz | Iterable[bytes | memoryview], media_type: str, headers: Mapping[str, str]
    ) -> dict[str, Any]:
        with self._transfer(path, content, media_type, **headers) as answer:
            return dict(json.loads(answer.read()))

    def results(self, job: str) -> Generator[dict[str, Any], None, None]:
        """The parts of an evaluation that is a job, in order, each as soon as it is computed; ``range`` says of which
        states. Raises ProblemError for a part that failed or was cancelled.
        """
        link, done = f"/v1/jobs/{step(job)}/items?page_size=100", 0
        while link is not None:
            page = self.request("GET", link).json()
            ended = [item for item in page["items"] if item["finished"] is not None]
            while done < len(page["items"]) and page["items"][done] in ended:
                yield self._part(page["items"][done])
                done += 1
            if done < len(page["items"]):
                sleep(PERIOD)
            else:
                link, done = page["links"]["next"], 0

    def _part(self, item: Mapping[str, Any]) -> dict[str, Any]:
        _require_result(item)
        (file,) = item["files"]
        content = self.request("GET", file["href"]).content
        if file["media_type"] == NPZ:
            found = as_answer(view_npz(np.frombuffer(content, np.uint8)))
        else:
            found = nested(next(arrow.read_tables(io.BytesIO(content))))
        return {**found, "range": item["result"]["range"]}

    def wait(
        self,
        job: str,
        told: Callable[[dict[str, Any]], None] | None = None,
        lost: Callable[[float, str], None] | None = None,
        patience: float = PATIENCE,
    ) -> dict[str, Any]:
        """Wait until a job has ended, however long and whether or not the server restarts meanwhile; tell about it.

        ``lost`` is told for how many seconds the server has not answered, and why. Raises ServerLost when these are
        more than ``patience``.
        """
        since = None
        while True:
            begun = monotonic()
            try:
                view = dict(self.request("GET", f"/v1/jobs/{step(job)}", timeout=min(LOOK, patience)).json())
            except (httpx2.TransportError, ProblemError) as error:
                if isinstance(error, ProblemError) and error.status not in GATEWAY:
                    raise
                since = begun if since is None else since
                self._check_patience(job, monotonic() - since, patience, error)
                if lost is not None:
                    lost(monotonic() - since, str(error))
            else:
                since = None
                if told is not None:
                    told(view)
                if view["state"] in ("succeeded", "failed", "cancelled"):
                    return view
            sleep(min(PERIOD, patience))

    def _check_patience(self, job: str, waited: float, patience: float, error: Exception) -> None:
        if waited >= patience:
            message = f"{self.address} has not answered for {waited:.0f} s ({error})"
            raise ServerLost(f"{message}; the job {job} goes on with the server, and can be watched again") from error

    def _item_of_job(self, job: str) -> dict[str, Any]:
        self.wait(job)
        (item,) = self.job_items(job)
        _require_result(item)
        return item

    def events(self, job: str, after: int = 0) -> Iterator[tuple[int, str, dict[str, Any]]]:
        """What happens to a job behind the event ``after`` (number, type, data), until it or the connection ends."""
        headers = {"Last-Event-ID": str(after)} if after else {}
        with self._http.stream("GET", f"/v1/jobs/{step(job)}/events", headers=headers) as answer:
            if answer.is_error:
                answer.read()
                check(answer)
            fields: dict[str, str] = {}
            for line in answer.iter_lines():
                name, _, value = line.partition(": ")
                if line:
                    fields[name] = value
                elif "data" in fields:
                    yield int(fields["id"]), fields["event"], json.loads(fields["data"])
                    fields = {}


def _batches(rows: Mapping[str, np.ndarray[Any, Any]], size: int) -> Iterator[dict[str, Any]]:
    """Arrays of ``size`` bytes in all, in batches."""
    count = len(next(iter(rows.values())))
    rows_each = max(1, count * AT_ONCE // size)
    for start in range(0, count, rows_each):
        yield {name: x[start : start + rows_each] for name, x in rows.items()}


def _require_result(item: Mapping[str, Any]) -> None:
    if item["problem"] is not None:
        raise ProblemError(item["problem"]["status"], item["problem"])
    if item["state"] != "succeeded":
        raise ProblemError(409, {"detail": f"the item {item['position']} was {item['state']}"})


def joined_parts(parts: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """The parts of an evaluation as one answer."""
    columns = [flat(part) for part in parts]
    arrays = {
        name: np.concatenate([each[name] for each in columns])
        for name, value in columns[0].items()
        if isinstance(value, np.ndarray)
    }
    told = {name: _noted(parts, name) for name in ("failures", "warnings")}
    whole = nested({**columns[0], **arrays})
    return {**whole, "count": sum(part["count"] for part in parts), **told}


def _noted(parts: Sequence[Mapping[str, Any]], name: str) -> list[dict[str, Any]]:
    """What the parts say about their states, with the places of the states in the whole; the same is said once."""
    told = [placed(note, part["range"][0]) for part in parts for note in part.get(name, ())]
    return [note for i, note in enumerate(told) if "state" in note or note not in told[:i]]
