"""One server over HTTP: requests that are sent again where that helps, large bodies, pages."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from http.client import HTTPResponse
from pathlib import Path
from secrets import token_hex
from ssl import PROTOCOL_TLS_CLIENT, SSLContext
from types import TracebackType
from typing import Any, Self, TypeVar
from urllib.parse import urlencode, urlsplit

import httpx2
import numpy as np
from numpy.typing import NDArray

from substructures.client.answers import Answer, Page, plain
from substructures.client.bulk import Bulk, read_all
from substructures.client.files import whole
from substructures.client.problems import check, problem_of
from substructures.client.retries import Retries
from substructures.documents import write_json
from substructures.formats.arrays import Npz

Kind = TypeVar("Kind")
RETRIES = 3
KEY = "Idempotency-Key"
#: what stands in a header as one word
_KEY = re.compile(r"[!-~]+")


def require_address(address: str) -> None:
    """Raise ValueError unless it is that of a server."""
    if "://" not in address:
        raise ValueError(f"an address begins with http:// or https://: write http://{address}")
    try:
        parts = urlsplit(address)
        is_address = parts.scheme in ("http", "https") and bool(parts.hostname) and parts.port != 0
    except ValueError:  # of the port, or of an IPv6 address
        is_address = False
    if not is_address:
        raise ValueError(f"'{address}' is no address of a server: write http://HOST:PORT or https://HOST")


def _trust(address: str) -> SSLContext | bool:
    """Who is believed over TLS: as ever; nobody for an http:// address, as reading who takes longer than a request."""
    return True if urlsplit(address).scheme == "https" else SSLContext(PROTOCOL_TLS_CLIENT)


class Caller:
    """Talks to one server. All methods raise ProblemError, and httpx2.HTTPError when there is no answer."""

    def __init__(self, address: str, key: str | None = None, timeout: float = 60.0, retries: int = RETRIES) -> None:
        """``timeout``: seconds without a byte; ``retries``: how often a request is sent again at most where the server
        cannot be reached, is gone for a moment, or asks to wait; 0: never. Raises ValueError for what is no address,
        and for a key that no header can hold.
        """
        require_address(address)
        if key is not None and not _KEY.fullmatch(key):
            raise ValueError(
                "this is no key of a server, which is a word of letters, digits and '_' that begins with sub_"
            )
        self.address, self.timeout = address, timeout
        self._retries = Retries(retries, timeout)
        self._headers = {} if key is None else {"Authorization": f"Bearer {key}"}
        self._http = httpx2.Client(base_url=address, headers=self._headers, timeout=timeout, verify=_trust(address))
        self._bulk = Bulk(address, timeout)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Close all connections."""
        self._http.close()
        self._bulk.close()

    def request(
        self, method: str, path: str, body: Any = None, *, retries: int | None = None, **options: Any
    ) -> httpx2.Response:
        """Send one request; ``body`` is sent as JSON with exact numbers, arrays as lists.

        What changes something has an Idempotency-Key, so that it is done once however often it is sent.
        """
        headers = httpx2.Headers(options.pop("headers", None))
        if body is not None:
            options["content"] = write_json(plain(body), keys=list)
            headers.setdefault("Content-Type", "application/json")
        if _takes_key(method, path):
            headers.setdefault(KEY, token_hex(16))
        is_repeatable = method == "GET" or KEY in headers or _is_computed(method, path)
        send = partial(self._once, method, path, headers=headers, **options)
        return (self._retries if retries is None else Retries(retries, self.timeout)).ask(send, is_repeatable)

    def _once(self, method: str, path: str, **options: Any) -> httpx2.Response:
        answer = self._http.request(method, path, **options)
        check(answer)
        return answer

    def told(self, method: str, path: str, body: Any = None, **options: Any) -> Answer:
        """The JSON object that a request answers."""
        return Answer(self.request(method, path, body, **options).json())

    def _exchange(
        self, path: str, content: Npz, media_type: str, is_keyed: bool = False, **more: str
    ) -> tuple[int, NDArray[np.uint8]]:
        """Status and body of the answer to arrays; ``is_keyed``: it makes a job, which must not be made twice."""
        more = {KEY: token_hex(16), **more} if is_keyed else more

        def send() -> tuple[int, NDArray[np.uint8]]:
            """Once, as a whole."""
            with self._transfer(path, content, media_type, **more) as answer:
                return answer.status, read_all(answer)

        return self._retries.ask(send, True)

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
            if answer.status >= 300:
                raise problem_of(answer.status, httpx2.Headers(answer.getheaders()), answer.read())
            yield answer

    def download(self, path: str, target: Path) -> int:
        """Save what is at a path, however large, or nothing; its size in bytes."""
        with whole(target) as file:
            return self._retries.ask(lambda: self._download(path, file), True)

    def _download(self, path: str, target: Path) -> int:
        with self._http.stream("GET", path) as answer:
            if not answer.is_success:
                answer.read()
                check(answer)
            with target.open("wb") as file:
                return sum(file.write(chunk) for chunk in answer.iter_bytes())

    def _page(self, path: str, filters: Mapping[str, Any], made: Callable[[Any], Kind]) -> Page[Kind]:
        """One page, its items made of what was answered."""
        told = dict(self.request("GET", path + query(filters)).json())
        return Page([made(item) for item in told.pop("items")], told)

    def _pages(self, path: str, filters: Mapping[str, Any], made: Callable[[Any], Kind]) -> Iterator[Kind]:
        """The items of all pages."""
        link: str | None = path + query({"page_size": 200, **filters})
        while link is not None:
            page = self.request("GET", link).json()
            yield from map(made, page["items"])
            link = page["links"]["next"]


def query(filters: Mapping[str, Any]) -> str:
    """Options of a request behind its path; lists are given once for each item, None is left out."""
    given = {name: str(x).lower() if isinstance(x, bool) else x for name, x in filters.items() if x is not None}
    return f"?{urlencode(given, doseq=True)}" if given else ""


def _takes_key(method: str, path: str) -> bool:
    """Whether the contract has an Idempotency-Key there (section 6), and it is of use: evaluations store nothing, and
    answer sooner without (of one that takes so long that it becomes a job, a second job shares the results).
    """
    if method == "POST":
        return not _is_computed(method, path)
    return method in ("DELETE", "PATCH") and path.startswith("/v1/trees/")


def _is_computed(method: str, path: str) -> bool:
    return method == "POST" and path.partition("?")[0].endswith("/evaluations")
