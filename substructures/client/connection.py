"""One server over HTTP: requests, large bodies, pages, and problems as exceptions."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from http import HTTPStatus
from http.client import HTTPResponse
from pathlib import Path
from types import TracebackType
from typing import Any, Self
from urllib.parse import quote, urlencode

import httpx2

from substructures.client.bulk import Bulk
from substructures.documents import write_json
from substructures.formats.arrays import Npz


class ProblemError(Exception):
    """The service answered with a problem document, which is in ``problem``."""

    def __init__(self, status: int, problem: dict[str, Any]) -> None:
        self.status, self.problem = status, problem
        super().__init__(f"{status}: {_told(problem)}")


def _told(problem: Mapping[str, Any]) -> str:
    """The detail of a problem and its faults, each once: a detail often says the same as the faults."""
    detail, errors = str(problem.get("detail", "no details")), problem.get("errors", ())
    faults = [f"{e['pointer'] or '/'}: {e['message']}" for e in errors]
    if not faults or detail not in (errors[0]["message"], "; ".join(faults[:3])):
        return "\n  ".join([detail, *faults])
    return "\n  ".join([f"{len(faults)} faults", *faults]) if faults[1:] else faults[0]


def step(given: str) -> str:
    """A name or an id as one step of a path. Raises ValueError for what can be none."""
    if not given.strip("."):
        raise ValueError(f"a name or an id is needed, found '{given}'")
    return quote(given, safe="@:")


class Caller:
    """Talks to one server. All methods raise ProblemError, and httpx2.HTTPError when there is no answer."""

    def __init__(self, address: str, key: str | None = None, timeout: float = 60.0) -> None:
        self.address, self.timeout = address, timeout
        self._headers = {} if key is None else {"Authorization": f"Bearer {key}"}
        self._http = httpx2.Client(base_url=address, headers=self._headers, timeout=timeout)
        self._bulk = Bulk(address, timeout)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Close all connections."""
        self._http.close()
        self._bulk.close()

    def request(self, method: str, path: str, body: Any = None, **options: Any) -> httpx2.Response:
        """Send one request; ``body`` is sent as JSON with exact numbers."""
        if body is not None:
            options["content"] = write_json(body)
            options["headers"] = {"Content-Type": "application/json", **options.get("headers", {})}
        answer = self._http.request(method, path, **options)
        check(answer)
        return answer

    @contextmanager
    def _transfer(
        self, path: str, content: Npz | Iterable[bytes | memoryview], media_type: str, **more: str
    ) -> Iterator[HTTPResponse]:
        headers = {**self._headers, "Content-Type": media_type, "Accept": media_type, **more}
        is_repeatable = isinstance(content, Npz) and "Prefer" not in more  # not a job, which would be made twice
        if isinstance(content, Npz):
            headers["Content-Length"] = str(content.size)
            content = content.pieces
        with self._bulk.transfer(path, content, headers, is_repeatable=is_repeatable) as answer:
            if answer.status >= 400:
                raise _problem(answer.status, answer.headers.get_content_type(), answer.read())
            yield answer

    def download(self, path: str, target: Path) -> int:
        """Save what is at a path, however large; its size in bytes."""
        with self._http.stream("GET", path) as answer:
            if answer.is_error:
                answer.read()
                check(answer)
            with target.open("wb") as file:
                for chunk in answer.iter_bytes():
                    file.write(chunk)
                return file.tell()

    def _pages(self, path: str, filters: Mapping[str, str]) -> Iterator[dict[str, Any]]:
        link: str | None = f"{path}?{urlencode({**filters, 'page_size': 200})}"
        while link is not None:
            page = self.request("GET", link).json()
            yield from page["items"]
            link = page["links"]["next"]


def check(answer: httpx2.Response) -> None:
    """Raise ProblemError unless it is a success."""
    if answer.is_error:
        raise _problem(answer.status_code, answer.headers.get("content-type", ""), answer.content)


def _problem(status: int, media_type: str, body: bytes) -> ProblemError:
    is_problem = media_type.startswith("application/problem+json")
    return ProblemError(status, json.loads(body) if is_problem else {"detail": HTTPStatus(status).phrase})
