"""A small typed client of the HTTP interface."""

from __future__ import annotations

import json
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from contextlib import contextmanager
from http import HTTPStatus
from http.client import HTTPResponse
from pathlib import Path
from time import sleep
from types import TracebackType
from typing import Any, Self
from urllib.parse import urlencode

import httpx2
import numpy as np

from service import arrow
from service.arrays import MEDIA_TYPE as NPZ
from service.arrays import flat, nested, view_npz, write_npz
from service.bulk import read_all, transfer
from substructures.documents import write_json

PERIOD, PATIENCE = 0.5, 60.0  # seconds between looks at a job, and without an answer


class ProblemError(Exception):
    """The service answered with a problem document, which is in ``problem``."""

    def __init__(self, status: int, problem: dict[str, Any]) -> None:
        self.status, self.problem = status, problem
        lines = [f"{status}: {problem.get('detail', 'no details')}"]
        lines += [f"  {e['pointer'] or '/'}: {e['message']}" for e in problem.get("errors", ())]
        super().__init__("\n".join(lines))


class Client:
    """Talks to one server. All methods raise ProblemError, and httpx2.HTTPError when there is no answer."""

    def __init__(self, address: str, key: str | None = None, timeout: float = 60.0) -> None:
        self.address, self.timeout = address, timeout
        self._headers = {} if key is None else {"Authorization": f"Bearer {key}"}
        self._http = httpx2.Client(base_url=address, headers=self._headers, timeout=timeout)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Close all connections."""
        self._http.close()

    def request(self, method: str, path: str, body: Any = None, **options: Any) -> httpx2.Response:
        """Send one request; ``body`` is sent as JSON with exact numbers."""
        if body is not None:
            options["content"] = write_json(body)
            options["headers"] = {"Content-Type": "application/json", **options.get("headers", {})}
        answer = self._http.request(method, path, **options)
        _check(answer)
        return answer

    def submit(self, definition: Any) -> tuple[dict[str, Any], bool]:
        """Submit a definition: the version, and whether it is new."""
        answer = self.request("POST", "/v1/substructures", definition)
        if answer.status_code == 202:
            return self._made_by_job(answer.json()["id"]), True
        return dict(answer.json()), answer.status_code == 201

    def substructure(self, ref: str) -> dict[str, Any]:
        """A version of the catalogue."""
        return dict(self.request("GET", f"/v1/substructures/{ref}").json())

    def create_tree(self, spec: Any) -> dict[str, Any]:
        """Couple the instances of a tree."""
        return self._made("/v1/trees", spec)

    def couple(self, tree: str, instance: Any) -> dict[str, Any]:
        """Couple one more instance onto a tree; the new revision."""
        return self._made(f"/v1/trees/{tree}/couplings", instance)

    def formula(
        self,
        tree: str,
        quantity: str,
        format: str = "text",  # noqa: A002 -- the name in the contract
        form: str = "compact",
        bind: str = "",
        **options: str | list[str],
    ) -> str:
        """A quantity of a tree as text in one of the formats; ``options``: of first_integrals, state_space, ..."""
        wanted = {"format": format, "form": form, "bind": bind, **options}
        return self.request("GET", f"/v1/trees/{tree}/{quantity}", params=wanted).text

    def evaluate(self, tree: str, **request: Any) -> dict[str, Any]:
        """Numbers: ``quantities``, ``q``, ``qd``, ``parameters``, ... (the HTTP contract, section 4).

        When one of the values is a numpy array, all travel as npz, and arrays come back in place of lists.
        """
        path = f"/v1/trees/{tree}/evaluations"
        given = flat(request)
        if not any(isinstance(value, np.ndarray) for value in given.values()):
            return dict(self.request("POST", path, request).json())
        body = b"".join(write_npz(given).pieces)
        with self._transfer(path, body, NPZ) as answer:
            return _result(view_npz(read_all(answer)))

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
        """The answer to a request for numbers in one of its media types, and ``status`` and ``is_right`` of a motion.

        Waits where it takes so long that it becomes a job.
        """
        plain = {name: x.tolist() if isinstance(x, np.ndarray) else x for name, x in request.items()}
        path, headers = f"/v1/trees/{tree}/{analysis}", {"Accept": media_type}
        answer = self.request("POST", path, plain, headers=headers)
        if answer.status_code != 202:
            right = answer.headers.get("trajectory-right", "true") == "true"
            return answer.content, {"status": answer.headers.get("trajectory-status", "finished"), "is_right": right}
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
        tables = (arrow.Table(flat(batch)) for batch in batches)
        content = (bytes(piece) for piece in arrow.write_tables(tables, constants))
        with self._transfer(f"/v1/trees/{tree}/evaluations", content, arrow.MEDIA_TYPE) as answer:
            for columns in arrow.read_tables(answer):
                yield nested(columns)

    @contextmanager
    def _transfer(self, path: str, content: bytes | Iterable[bytes], media_type: str) -> Iterator[HTTPResponse]:
        headers = {**self._headers, "Content-Type": media_type, "Accept": media_type}
        with transfer(self.address, path, content, headers, self.timeout) as answer:
            if answer.status >= 400:
                raise _problem(answer.status, answer.headers.get_content_type(), answer.read())
            yield answer

    def _made(self, path: str, body: Any) -> dict[str, Any]:
        answer = self.request("POST", path, body)
        return self._made_by_job(answer.json()["id"]) if answer.status_code == 202 else dict(answer.json())

    def _made_by_job(self, job: str) -> dict[str, Any]:
        """What a request has made that took so long that it became a job of one item."""
        return dict(self.request("GET", self._item_of_job(job)["result"]["location"]).json())

    def _item_of_job(self, job: str) -> dict[str, Any]:
        self.wait(job)
        (item,) = self.job_items(job)
        if item["problem"] is not None:
            raise ProblemError(item["problem"]["status"], item["problem"])
        if item["state"] != "succeeded":
            raise ProblemError(409, {"detail": f"the job {job} was {item['state']}"})
        return item

    def submit_job(self, submission: Any) -> dict[str, Any]:
        """Queue ``{"kind", "items"}`` or ``{"kind", "template", "choices"}``: the job."""
        return dict(self.request("POST", "/v1/jobs", submission).json())

    def job(self, job: str) -> dict[str, Any]:
        """A job with its progress."""
        return dict(self.request("GET", f"/v1/jobs/{job}").json())

    def jobs(self, **filters: str) -> Iterator[dict[str, Any]]:
        """All jobs (of a ``state``, of a ``kind``), the newest first."""
        return self._pages("/v1/jobs", filters)

    def job_items(self, job: str, **filters: str) -> Iterator[dict[str, Any]]:
        """The items of a job (in a ``state``) with their results and problems."""
        return self._pages(f"/v1/jobs/{job}/items", filters)

    def cancel_job(self, job: str) -> dict[str, Any]:
        """Cancel what is not finished."""
        return dict(self.request("POST", f"/v1/jobs/{job}/cancel").json())

    def wait(self, job: str, told: Callable[[dict[str, Any]], None] | None = None) -> dict[str, Any]:
        """Wait until a job has ended, however long and whether or not the server restarts meanwhile; tell about it."""
        failures = 0
        while True:
            try:
                view = self.job(job)
            except httpx2.TransportError:
                failures += 1
                if failures > PATIENCE / PERIOD:
                    raise
                sleep(PERIOD)
                continue
            failures = 0
            if told is not None:
                told(view)
            if view["state"] in ("succeeded", "failed", "cancelled"):
                return view
            sleep(PERIOD)

    def events(self, job: str, after: int = 0) -> Iterator[tuple[int, str, dict[str, Any]]]:
        """What happens to a job behind the event ``after`` (number, type, data), until it or the connection ends."""
        headers = {"Last-Event-ID": str(after)} if after else {}
        with self._http.stream("GET", f"/v1/jobs/{job}/events", headers=headers) as answer:
            if answer.is_error:
                answer.read()
                _check(answer)
            fields: dict[str, str] = {}
            for line in answer.iter_lines():
                name, _, value = line.partition(": ")
                if line:
                    fields[name] = value
                elif "data" in fields:
                    yield int(fields["id"]), fields["event"], json.loads(fields["data"])
                    fields = {}

    def download(self, path: str, target: Path) -> int:
        """Save what is at a path, however large; its size in bytes."""
        with self._http.stream("GET", path) as answer, target.open("wb") as file:
            if answer.is_error:
                answer.read()
                _check(answer)
            for chunk in answer.iter_bytes():
                file.write(chunk)
            return file.tell()

    def _pages(self, path: str, filters: Mapping[str, str]) -> Iterator[dict[str, Any]]:
        link: str | None = f"{path}?{urlencode({**filters, 'page_size': 200})}"
        while link is not None:
            page = self.request("GET", link).json()
            yield from page["items"]
            link = page["links"]["next"]


def _check(answer: httpx2.Response) -> None:
    """Raise ProblemError unless it is a success."""
    if answer.is_error:
        raise _problem(answer.status_code, answer.headers.get("content-type", ""), answer.content)


def _problem(status: int, media_type: str, body: bytes) -> ProblemError:
    is_problem = media_type.startswith("application/problem+json")
    return ProblemError(status, json.loads(body) if is_problem else {"detail": HTTPStatus(status).phrase})


def _result(arrays: Mapping[str, np.ndarray[Any, Any]]) -> dict[str, Any]:
    """The answer as JSON would have it, with arrays for the quantities."""
    result = nested({name: a if a.dtype.kind == "f" else a.tolist() for name, a in arrays.items()})
    failures = result["failures"]
    rows = zip(*failures.values(), strict=True)
    return {**result, "failures": [dict(zip(failures, row, strict=True)) for row in rows]}
