"""Jobs of one server: submit, watch, read results, also of states that are uploaded."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from pathlib import Path
from secrets import token_hex
from time import monotonic, sleep
from typing import Any, Self

import httpx2
import numpy as np

from substructures.client.answers import Answer
from substructures.client.connection import KEY, Caller
from substructures.client.numbers import Evaluation
from substructures.client.problems import ProblemError, check
from substructures.client.progress import Bar, counted
from substructures.client.results import part_of, require_result, result_of
from substructures.client.retries import GATEWAY
from substructures.client.steps import Referable, step
from substructures.formats import arrow
from substructures.formats.arrays import MEDIA_TYPE as NPZ
from substructures.formats.arrays import flat, write_npz
from substructures.formats.columns import parted, request_of

#: seconds between looks at a job, for one look, and without an answer
PERIOD, LOOK, PATIENCE = 0.5, 5.0, 60.0
AT_ONCE = 2**25  # bytes of states that are sent as npz, and in one batch of an Arrow stream
FORMATS = {"npz": NPZ, "arrow": arrow.MEDIA_TYPE}
ENDED = ("succeeded", "failed", "cancelled")


class ServerLost(httpx2.TransportError):
    """The server has not answered for too long."""


class Job(Answer):
    """A job as it was when it was last looked at; its methods look at it again."""

    id: str
    kind: str
    label: str
    state: str
    progress: dict[str, Any]
    retry_of: str | None
    created: str
    started: str | None
    finished: str | None
    error: dict[str, Any] | None

    def __init__(self, told: Mapping[str, Any], caller: JobCaller) -> None:
        super().__init__(told)
        self._caller = caller

    def __repr__(self) -> str:
        return f"Job {self['id']}: {self['kind']}, {self['state']}, {counted(self)}"

    @property
    def ref(self) -> str:
        """Its id."""
        return str(self["id"])

    @property
    def is_ended(self) -> bool:
        """Whether it succeeded, failed or was cancelled."""
        return self["state"] in ENDED

    def refresh(self) -> Self:
        """Look at it again."""
        self.update(self._caller.job(self))
        return self

    def wait(self, progress: bool = False, patience: float = PATIENCE) -> Self:
        """Wait until it has ended, with a bar on the stream of errors if ``progress``.

        Raises ServerLost when the server has not answered for ``patience`` seconds.
        """
        bar = Bar(sys.stderr) if progress else None
        told, lost = (None, None) if bar is None else (bar.show, bar.lost)
        self.update(self._caller.wait(self, told, lost, patience))
        if bar is not None:
            bar.end(self)
        return self

    def each(self, **filters: str) -> Iterator[Answer]:
        """Its items (in a ``state``) with their results and problems; ``items()`` is that of dictionaries."""
        return self._caller.job_items(self, **filters)

    def results(self) -> Iterator[Any]:
        """What its items have found, in order, each as soon as it is there: evaluations, motions, answers, bytes of
        other files; also what there is of an analysis that failed, whose ``status`` or ``is_right`` says so. Raises
        ProblemError for another item that failed, or was cancelled.
        """
        return self._caller.found(self, self["kind"])

    def events(self, after: int = 0) -> Iterator[tuple[int, str, dict[str, Any]]]:
        """What happens to it behind the event ``after``: number, type, data."""
        return self._caller.events(self, after)

    def archive(self, target: Path) -> int:
        """Save all items with their files as a zip file; its size in bytes."""
        return self._caller.job_archive(self, target)

    def cancel(self) -> Self:
        """Cancel what is not finished."""
        self.update(self._caller.cancel_job(self))
        return self

    def retry(self, label: str | None = None) -> Job:
        """What failed or was cancelled once more: a new job."""
        return self._caller.retry_job(self, label)

    def remove(self) -> None:
        """Remove it with its results; it has to have ended."""
        self._caller.remove_job(self)


class JobCaller(Caller):
    """What can be done with jobs; ``job`` is an id or a Job."""

    def _job(self, told: Mapping[str, Any]) -> Job:
        return Job(told, self)

    def submit_job(self, submission: Any) -> Job:
        """Queue ``{"kind", "items"}`` or ``{"kind", "template", "choices"}``: the job."""
        return self._job(self.told("POST", "/v1/jobs", submission))

    def job(self, job: str | Referable) -> Job:
        """A job with its progress."""
        return self._job(self.told("GET", f"/v1/jobs/{step(job)}"))

    def jobs(self, **filters: str) -> Iterator[Job]:
        """All jobs (of a ``state``, of a ``kind``, with a ``label``), the newest first."""
        return self._pages("/v1/jobs", filters, self._job)

    def job_items(self, job: str | Referable, **filters: str) -> Iterator[Answer]:
        """The items of a job (in a ``state``) with their results and problems."""
        return self._pages(f"/v1/jobs/{step(job)}/items", filters, Answer)

    def job_file(self, job: str | Referable, position: int, name: str = "result") -> bytes:
        """A file of the result of an item."""
        return self.request("GET", f"/v1/jobs/{step(job)}/items/{position}/files/{step(name)}").content

    def job_archive(self, job: str | Referable, target: Path) -> int:
        """Save all items of a job with their files as a zip file; its size in bytes."""
        return self.download(f"/v1/jobs/{step(job)}/archive", target)

    def cancel_job(self, job: str | Referable) -> Job:
        """Cancel what is not finished."""
        return self._job(self.told("POST", f"/v1/jobs/{step(job)}/cancel"))

    def retry_job(self, job: str | Referable, label: str | None = None) -> Job:
        """What of a job failed or was cancelled once more: the new job."""
        body = None if label is None else {"label": label}
        return self._job(self.told("POST", f"/v1/jobs/{step(job)}/retry", body))

    def remove_job(self, job: str | Referable) -> None:
        """Remove a job that has ended, with its results."""
        self.request("DELETE", f"/v1/jobs/{step(job)}")

    def submit_states(
        self,
        tree: str | Referable,
        states: Mapping[str, Any] | Iterable[Mapping[str, Any]],
        form: str = "npz",
        **constants: Any,
    ) -> Job:
        """Queue the evaluation of a tree for many states: the job, when all states are on the disk of the server.

        ``states``: arrays or lists by name (``q``, ``qd``, ...), or batches of arrays as for ``evaluate_batches``;
        ``constants``: what is the same for all (``quantities``, ``parameters``, ...); ``form``: npz or arrow, of the
        results. More than 32 MiB, and batches, travel as an Arrow stream, which needs pyarrow.
        """
        path, headers = f"/v1/trees/{step(tree)}/evaluations", {"Prefer": "respond-async", "Accept": FORMATS[form]}
        if isinstance(states, Mapping):
            if not any(isinstance(x, np.ndarray) for x in flat(states).values()):
                keyed = {KEY: token_hex(16), **headers}
                return self._job(self.told("POST", path, {**states, **constants}, headers=keyed))
            rows, rest = parted(flat(states))
            size = sum(x.nbytes for x in rows.values())
            if size <= AT_ONCE:
                arrays = write_npz({**rows, **rest, **flat(constants)})
                _, told = self._exchange(path, arrays, NPZ, is_keyed=True, **headers)
                return self._job(json.loads(bytes(told)))
            plain = {name: x.tolist() if isinstance(x, np.ndarray) else x for name, x in rest.items()}
            constants = request_of({}, {**plain, **flat(constants)})
            states = _batches(rows, size)
        tables = (arrow.ArrowTable(flat(batch)) for batch in states)
        content = arrow.write_tables(tables, constants)  # can be sent once
        with self._transfer(path, content, arrow.MEDIA_TYPE, **headers) as answer:
            return self._job(json.loads(answer.read()))

    def results(self, job: str | Referable) -> Generator[Evaluation, None, None]:
        """The parts of an evaluation that is a job, in order, each as soon as it is computed; ``range`` says of which
        states. Raises ProblemError for a part that failed or was cancelled.
        """
        for item in self._ended(job):
            require_result(item)
            yield part_of(item, self.request("GET", item["files"][0]["href"]).content)

    def found(self, job: str | Referable, kind: str) -> Iterator[Any]:
        """What the items of a job of a ``kind`` have found, as :meth:`Job.results`."""
        for item in self._ended(job):
            require_result(item)
            files = item["files"]
            yield result_of(kind, item, self.request("GET", files[0]["href"]).content if files else None)

    def _ended(self, job: str | Referable) -> Iterator[dict[str, Any]]:
        """The items of a job in order, each as soon as it has ended."""
        link, done = f"/v1/jobs/{step(job)}/items?page_size=100", 0
        while link is not None:
            page = self.request("GET", link).json()
            ended = [item for item in page["items"] if item["finished"] is not None]
            while done < len(page["items"]) and page["items"][done] in ended:
                yield page["items"][done]
                done += 1
            if done < len(page["items"]):
                sleep(PERIOD)
            else:
                link, done = page["links"]["next"], 0

    def wait(
        self,
        job: str | Referable,
        told: Callable[[dict[str, Any]], None] | None = None,
        lost: Callable[[float, str], None] | None = None,
        patience: float = PATIENCE,
    ) -> Job:
        """Wait until a job has ended, however long and whether or not the server restarts meanwhile; tell about it.

        ``lost`` is told for how many seconds the server has not answered, and why. Raises ServerLost when these are
        more than ``patience``.
        """
        since, path = None, f"/v1/jobs/{step(job)}"
        while True:
            begun = monotonic()
            try:
                view = self._job(self.told("GET", path, retries=0, timeout=min(LOOK, patience)))
            except (httpx2.TransportError, ProblemError) as error:
                if isinstance(error, ProblemError) and error.status not in GATEWAY:
                    raise
                since = begun if since is None else since
                self._check_patience(path, monotonic() - since, patience, error)
                if lost is not None:
                    lost(monotonic() - since, str(error))
            else:
                since = None
                if told is not None:
                    told(view)
                if view.is_ended:
                    return view
            sleep(min(PERIOD, patience))

    def _check_patience(self, path: str, waited: float, patience: float, error: Exception) -> None:
        if waited >= patience:
            message = f"{self.address} has not answered for {waited:.0f} s ({error})"
            job = path.rpartition("/")[2]
            raise ServerLost(f"{message}; the job {job} goes on with the server, and can be watched again") from error

    def _item_of_job(self, job: str) -> Answer:
        self.wait(job)
        (item,) = self.job_items(job)
        require_result(item)
        return item

    def content_of(self, answer: httpx2.Response) -> bytes:
        """What was answered, as :meth:`file_of`."""
        return self.file_of(answer)[1]

    def file_of(self, answer: httpx2.Response) -> tuple[str, bytes]:
        """The name, if there is one, and the content of what was answered, or of the file of the one item of the job
        that it became as it took so long."""
        if answer.status_code != 202:
            return answer.headers.get("content-disposition", "").partition('filename="')[2].rstrip('"'), answer.content
        item = self._item_of_job(answer.json()["id"])
        (file,) = item["files"]
        return item["result"].get("name", ""), self.request("GET", file["href"]).content

    def _made(self, method: str, path: str, body: Any = None) -> dict[str, Any]:
        """What a request has made, also where it took so long that it became a job of one item."""
        answer = self.request(method, path, body)
        return self._made_by_job(answer.json()["id"]) if answer.status_code == 202 else answer.json()

    def _made_by_job(self, job: str) -> dict[str, Any]:
        return dict(self.request("GET", self._item_of_job(job)["result"]["location"]).json())

    def events(self, job: str | Referable, after: int = 0) -> Iterator[tuple[int, str, dict[str, Any]]]:
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
