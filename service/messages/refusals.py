"""What cannot be served, and what a client is told about it: the part of a problem document that needs no request.

::

    Refused                a request that cannot be served: status, code, detail
    InvalidInput           422, one error for every fault, with a pointer into the body
    TooLarge, MissingValue 422
    VerificationFailed     500, named: formulas that are wrong are not used
    NotDerived             503: what is stored is derived anew first
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from http import HTTPStatus
from typing import Any, Literal

from substructures.documents import pointer_step
from substructures.errors import Fault, InvalidInput, MissingValue, TooLarge, VerificationFailed

SHOWN = 20  # faults
MEMBERS = ("type", "title", "status", "detail", "code", "errors")  # of every problem document


class Refused(Exception):
    """A request that cannot be served. ``code`` is for programs, ``detail`` for people."""

    def __init__(
        self,
        status: int,
        code: str,
        detail: str,
        faults: Sequence[Fault] = (),
        headers: Mapping[str, str] | None = None,
        **members: Any,
    ) -> None:
        super().__init__(detail)
        self.status, self.code, self.detail = status, code, detail
        self.faults, self.headers, self.members = tuple(faults), dict(headers or {}), members


class NotDerived(Exception):
    """Content that this server has not derived, or not as it is stored now: it is derived anew before it is used.

    ``kind``: ``part`` with its digest as ``key``, or ``tree`` with name and revision as in ``cell@2``. ``is_newest``: a
    tree that another version of the software coupled will not do, either.
    """

    def __init__(self, kind: Literal["part", "tree"], key: str, is_newest: bool = False) -> None:
        super().__init__(f"the {kind} {key} is being derived anew from its document; ask again")
        self.kind, self.key, self.is_newest = kind, key, is_newest


class LongWork(TimeoutError):
    """What is asked for would take so long that it should not be begun: it becomes a job."""


class StaleError(Exception):
    """A resource was changed while a change of it was being prepared: prepare again."""


def not_found(detail: str, code: str = "not-found") -> Refused:
    """404."""
    return Refused(404, code, detail)


def unprocessable(code: str, detail: str, pointer: str = "", **members: Any) -> Refused:
    """422 with a pointer to the culprit."""
    return Refused(422, code, detail, [Fault(pointer, code, detail)], **members)


def known_refusal(error: Exception) -> Refused | None:
    """What a client is told about an exception that is raised on purpose; None for any other."""
    match error:
        case Refused():
            return error
        case NotDerived():
            return Refused(503, "not-derived", str(error), headers={"Retry-After": "1"})
        case InvalidInput():
            detail = "; ".join(str(fault) for fault in error.faults[:3])
            return Refused(422, "invalid-document", detail, error.faults)
        case TooLarge():
            return unprocessable("too-large", str(error), what=error.what, size=error.size, limit=error.limit)
        case MissingValue():
            return unprocessable("missing-value", str(error), "/parameters" + pointer_step(error.name))
        case VerificationFailed():
            return Refused(500, "verification-failed", f"{error}; nothing was stored or computed with it")
    return None


def problem(refused: Refused, **request: str) -> dict[str, Any]:
    """The problem document (RFC 9457); ``request``: what is known of the request it answers.

    Of many faults the first are listed, and ``count`` says how many there are.
    """
    faults = refused.faults
    counted = {"count": len(faults)} if len(faults) > SHOWN else {}
    return {
        "type": f"urn:problem-type:substructures:{refused.code}",
        "title": HTTPStatus(refused.status).phrase,
        "status": refused.status,
        "detail": refused.detail,
        **request,
        "code": refused.code,
        "errors": [{"pointer": f.pointer, "code": f.code, "message": f.message} for f in faults[:SHOWN]],
        **counted,
        **refused.members,
    }


def refused_of(document: Mapping[str, Any]) -> Refused:
    """The refusal that a problem document tells of."""
    faults = [Fault(each["pointer"], each["code"], each["message"]) for each in document["errors"]]
    members = {name: value for name, value in document.items() if name not in MEMBERS}
    return Refused(document["status"], document["code"], document["detail"], faults, **members)


@contextmanager
def moved(move: Callable[[str], str]) -> Iterator[None]:
    """Faults that are found here, by this process or another one, have their pointers moved."""
    try:
        yield
    except InvalidInput as error:
        raise error.moved(move) from None
    except Refused as error:
        faults = [replace(fault, pointer=move(fault.pointer)) for fault in error.faults]
        raise Refused(error.status, error.code, error.detail, faults, error.headers, **error.members) from None
