"""Problem documents (RFC 9457) as exceptions."""

from __future__ import annotations

import json
from collections.abc import Mapping
from http import HTTPStatus
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import httpx2


class ProblemError(Exception):
    """The service answered with a problem document, which is in ``problem``.

    ``retry_after``: seconds after which asking once more may help, where the answer says that.
    """

    def __init__(self, status: int, problem: dict[str, Any], retry_after: float | None = None) -> None:
        self.status, self.problem, self.retry_after = status, problem, retry_after
        super().__init__(f"{status}: {_told(problem)}")


def _told(problem: Mapping[str, Any]) -> str:
    """The detail of a problem and its faults, each once: a detail often says the same as the faults."""
    detail, errors = str(problem.get("detail", "no details")), problem.get("errors", ())
    faults = [f"{e['pointer'] or '/'}: {e['message']}" for e in errors]
    if not faults or detail not in (errors[0]["message"], "; ".join(faults[:3])):
        return "\n  ".join([detail, *faults])
    return "\n  ".join([f"{len(faults)} faults", *faults]) if faults[1:] else faults[0]


def check(answer: httpx2.Response) -> None:
    """Raise ProblemError unless it is a success; no redirect is followed."""
    if not answer.is_success:
        raise problem_of(answer.status_code, answer.headers, answer.content)


def problem_of(status: int, headers: Mapping[str, str], body: bytes) -> ProblemError:
    """What an answer that is no success tells; ``headers`` find names in any case."""
    is_problem = headers.get("content-type", "").startswith("application/problem+json")
    seconds = headers.get("retry-after", "")
    place = f" to {headers['location']}" if "location" in headers else ""
    told = json.loads(body) if is_problem else {"detail": _phrase(status) + place}
    return ProblemError(status, told, float(seconds) if seconds.isascii() and seconds.isdigit() else None)


def _phrase(status: int) -> str:
    return HTTPStatus(status).phrase if status in set(HTTPStatus) else "no details"
