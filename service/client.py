"""A small typed client of the HTTP interface."""

from __future__ import annotations

import json
from collections.abc import Generator, Iterable, Iterator, Mapping
from contextlib import contextmanager
from http import HTTPStatus
from http.client import HTTPResponse
from types import TracebackType
from typing import Any, Self

import httpx2
import numpy as np

from service import arrow
from service.arrays import MEDIA_TYPE as NPZ
from service.arrays import flat, member, nested, npz_pieces, view_npz
from service.bulk import read_all, transfer
from substructures.documents import write_json


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
        if answer.is_error:
            raise _problem(answer.status_code, answer.headers.get("content-type", ""), answer.content)
        return answer

    def submit(self, definition: Any) -> tuple[dict[str, Any], bool]:
        """Submit a definition: the version, and whether it is new."""
        answer = self.request("POST", "/v1/substructures", definition)
        return dict(answer.json()), answer.status_code == 201

    def substructure(self, ref: str) -> dict[str, Any]:
        """A version of the catalogue."""
        return dict(self.request("GET", f"/v1/substructures/{ref}").json())

    def create_tree(self, spec: Any) -> dict[str, Any]:
        """Couple the instances of a tree."""
        return dict(self.request("POST", "/v1/trees", spec).json())

    def couple(self, tree: str, instance: Any) -> dict[str, Any]:
        """Couple one more instance onto a tree; the new revision."""
        return dict(self.request("POST", f"/v1/trees/{tree}/couplings", instance).json())

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
        body = b"".join(npz_pieces(member(name, value) for name, value in given.items()))
        with self._transfer(path, body, NPZ) as answer:
            return _result(view_npz(read_all(answer)))

    def analyse(self, tree: str, analysis: str, **request: Any) -> dict[str, Any]:
        """Numbers that follow from the equations of motion: ``linearisations``, ``equilibria``, ``root-loci``, ..."""
        return dict(self.analysis(tree, analysis, request).json())

    def simulate(self, tree: str, **request: Any) -> dict[str, Any]:
        """A motion with its checks; ``t``, ``q``, ``qd`` and ``series`` are arrays."""
        found = nested(view_npz(np.frombuffer(self.analysis(tree, "simulations", request, NPZ).content, np.uint8)))
        return {**json.loads(str(found.pop("summary"))), **found}

    def analysis(self, tree: str, analysis: str, request: Any, media_type: str = "application/json") -> httpx2.Response:
        """The answer to a request for numbers in one of its media types; headers tell whether a motion is right."""
        plain = {name: x.tolist() if isinstance(x, np.ndarray) else x for name, x in request.items()}
        path, headers = f"/v1/trees/{tree}/{analysis}", {"Accept": media_type}
        return self.request("POST", path, plain, headers=headers)

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


def _problem(status: int, media_type: str, body: bytes) -> ProblemError:
    is_problem = media_type.startswith("application/problem+json")
    return ProblemError(status, json.loads(body) if is_problem else {"detail": HTTPStatus(status).phrase})


def _result(arrays: Mapping[str, np.ndarray[Any, Any]]) -> dict[str, Any]:
    """The answer as JSON would have it, with arrays for the quantities."""
    result = nested({name: a if a.dtype.kind == "f" else a.tolist() for name, a in arrays.items()})
    failures = result["failures"]
    rows = zip(*failures.values(), strict=True)
    return {**result, "failures": [dict(zip(failures, row, strict=True)) for row in rows]}
