"""A small typed client of the HTTP interface."""

from __future__ import annotations

from types import TracebackType
from typing import Any, Self

import httpx2

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
        self.address = address
        headers = {} if key is None else {"Authorization": f"Bearer {key}"}
        self._http = httpx2.Client(base_url=address, headers=headers, timeout=timeout)

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
            is_problem = answer.headers.get("content-type", "").startswith("application/problem+json")
            raise ProblemError(answer.status_code, answer.json() if is_problem else {"detail": answer.reason_phrase})
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

    def formula(self, tree: str, quantity: str, format: str = "text", form: str = "compact", bind: str = "") -> str:  # noqa: A002 -- the name in the contract
        """A quantity of a tree as text in one of the formats."""
        wanted = {"format": format, "form": form, "bind": bind}
        return self.request("GET", f"/v1/trees/{tree}/{quantity}", params=wanted).text

    def evaluate(self, tree: str, **request: Any) -> dict[str, Any]:
        """Numbers: ``quantities``, ``q``, ``qd``, ``parameters``, ... (the HTTP contract, section 4)."""
        return dict(self.request("POST", f"/v1/trees/{tree}/evaluations", request).json())
