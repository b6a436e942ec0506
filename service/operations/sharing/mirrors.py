"""All public parts of another instance, stored here one by one: what is stored is not asked for again.

Every part is a transaction of its own, so that a mirror that was killed goes on with what is missing. Of what the other
side says nothing is believed: it is asked at its own address alone, and what it sends is derived anew as any bundle is.
"""

from __future__ import annotations

import io
import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from time import sleep
from typing import Any

import httpx2

from service.content.bundles import BundledPart, read_bundle
from service.messages.references import Reference, parse_reference
from service.messages.refusals import Refused, known_refusal
from service.messages.viewer import PUBLIC, Viewer
from service.operations import owners
from service.operations.sharing import bundles
from service.operations.sharing.bundles import Imported
from service.queries import catalogue
from service.queries.catalogue import Version
from service.queries.common import is_conflict
from service.schemas.entries import PLAIN
from service.sources import SETTING, Source
from service.store.store import Store
from substructures.client import Client, ProblemError
from substructures.errors import InvalidInput

AT_ONCE = 20  # parts of a bundle
MOST = 200_000  # parts of an instance
LISTED = 100  # parts that a result names, of each outcome
PAUSES = (0.5, 2.0, 8.0)  # seconds before a request is sent again that was not answered
ATTEMPTS = 8  # on a part, where others store at the same time
GONE = (429, 502, 503, 504)  # of a server that may answer later
DENIED = (401, 403)  # for the key, or for want of one

Told = Callable[[float], None]


@dataclass
class Mirrored:
    """What became of the parts that were offered: references here, and of those that were refused why; ``differing``:
    those whose formulas are others there than what was derived of their definitions here.
    """

    source: str
    offered: int = 0
    stored: list[str] = field(default_factory=list)
    same: list[str] = field(default_factory=list)
    differing: list[str] = field(default_factory=list)
    refused: list[dict[str, str]] = field(default_factory=list)

    def refuse(self, name: str, digest: str, code: str, message: str) -> None:
        """Note a part that is not stored."""
        self.refused.append({"name": name, "digest": digest, "code": code, "message": message})

    def summary(self) -> dict[str, Any]:
        """Counts, and the first of each."""
        outcomes: dict[str, Sequence[Any]] = {"stored": self.stored, "same": self.same, "differing": self.differing}
        outcomes["refused"] = self.refused
        told = {name: {"count": len(some), "items": list(some[:LISTED])} for name, some in outcomes.items()}
        return {"source": self.source, "offered": self.offered, **told}


Offer = tuple[str, str]  # name, digest


class Mirror:
    """One run for one source. ``told``: is told the share that is done, and raises where it is to end."""

    def __init__(self, store: Store, viewer: Viewer, source: Source, max_nodes: int, told: Told) -> None:
        self._store, self._viewer, self._max_nodes, self._told = store, viewer, max_nodes, told
        self._done = 0  # parts that were looked at
        self._client, self._has_key = Client(source.address, source.key), source.key is not None
        self._found = Mirrored(source.address)

    def run(self) -> dict[str, Any]:
        """Store what is missing: counts and lists. Raises Refused 502 where the source does not answer as it should,
        and what was stored before stays.
        """
        with self._client:
            missing = self._missing(list(dict.fromkeys(self._offers())))
            for start in range(0, len(missing), AT_ONCE):
                self._copy(missing[start : start + AT_ONCE])
        return self._found.summary()

    def _tell(self) -> None:
        self._told(self._done / max(1, self._found.offered))

    def _offers(self) -> Iterator[Offer]:
        """Name and digest of all public parts that the source lists, page by page."""
        token, count = None, 0
        while True:
            self._tell()
            page = self._json("/v1/substructures", {} if token is None else {"page_token": token})
            items = page.get("items")
            if not isinstance(items, list):
                raise self._failed("its list of parts is none")
            for item in items:
                offer = self._offer(item)
                if offer is not None:
                    yield offer
            count, token = count + len(items), page.get("next_page_token")
            if token is None:
                return
            if not isinstance(token, str) or not items or count > MOST:
                raise self._failed(f"its list of parts has no end, or more than {MOST:,} parts")

    def _offer(self, item: Any) -> Offer | None:
        """A part that is listed; None for one that only the key of this instance sees there."""
        given = item if isinstance(item, dict) else {}
        name, digest = given.get("name"), given.get("digest")
        if not isinstance(name, str) or not isinstance(digest, str) or parse_reference(f"{name}@{digest}") is None:
            raise self._failed("its list of parts has one without a name and a digest")
        return (name, digest) if given.get("visibility") == PUBLIC else None

    def _missing(self, offers: Sequence[Offer]) -> list[Offer]:
        """What is not stored, and may be: names of others are noted."""
        self._found.offered = len(offers)
        missing = []
        for name, digest in offers:
            version = self._stored_version(name, digest)
            if version is not None:
                self._found.same.append(_reference(version))
            elif self._may_store(name, digest):
                missing.append((name, digest))
        self._done = len(offers) - len(missing)
        return missing

    def _stored_version(self, name: str, digest: str) -> Version | None:
        with self._store.database.read() as connection:
            try:
                return catalogue.resolve(connection, self._viewer, Reference(name, digest=digest))
            except Refused:  # its content is gone from the store, and comes again
                return None

    def _may_store(self, name: str, digest: str) -> bool:
        """Whether the name is free or one's own; noted where it is not."""
        try:
            with self._store.database.read() as connection:
                owners.wanted(connection, self._viewer, "substructure", name, PLAIN)
        except Refused as error:
            self._found.refuse(name, digest, error.code, error.detail)
            return False
        return True

    def _copy(self, wanted: Sequence[Offer]) -> None:
        """Fetch parts and store them; where a bundle is refused, each of them alone."""
        self._tell()
        try:
            parts = {part.digest: part for part in self._fetched(wanted)}
        except (InvalidInput, ProblemError, Refused) as error:
            if isinstance(error, Refused) and error.status == 502:
                raise
            if len(wanted) > 1:
                for each in wanted:
                    self._copy([each])
            else:
                self._found.refuse(*wanted[0], *_reason(error))
                self._done += 1
            return
        for name, digest in wanted:
            self._tell()
            part = parts.get(digest)
            if part is None or part.name != name:
                self._found.refuse(name, digest, "invalid-bundle", "the bundle of the source is without it")
            else:
                self._store_part(part)
            self._done += 1

    def _store_part(self, part: BundledPart) -> None:
        try:
            found = self._committed(part)
        except Exception as error:
            known = known_refusal(error)
            if known is None:
                raise
            self._found.refuse(part.name, part.digest, known.code, known.detail)
        else:
            reference = _reference(found.version)
            (self._found.stored if found.is_new else self._found.same).append(reference)
            if not found.is_equal:
                self._found.differing.append(reference)

    def _committed(self, part: BundledPart) -> Imported:
        """What a part becomes; once more where another host was in the way."""
        for left in reversed(range(ATTEMPTS)):
            worker = self._store.job_worker(self._viewer.owner)
            ready = bundles.prepare(self._store, self._viewer, part, PLAIN, worker, self._max_nodes)
            try:
                with self._store.database.write() as connection:
                    (found,) = bundles.commit(connection, self._viewer, [part], [ready])
                return found
            except Exception as error:
                if not left or not is_conflict(error):
                    raise
        raise RuntimeError("no attempt was made")

    def _fetched(self, wanted: Sequence[Offer]) -> list[BundledPart]:
        refs = ",".join(f"{name}@{digest}" for name, digest in wanted)
        data = self._get("/v1/bundles", {"refs": refs}).content
        limits = self._store.settings.limits
        return read_bundle(io.BytesIO(data), limits.binary_bytes, limits.job_bytes)

    def _json(self, path: str, params: dict[str, str]) -> dict[str, Any]:
        try:
            found = json.loads(self._get(path, params).content)
        except ProblemError as error:
            code, why = _reason(error)
            is_other = error.status == 404 and code == "source-failed"  # an instance has that list, and codes
            raise self._failed(
                f"{path} is answered with {why}; is this the address of such a service?" if is_other else why
            ) from None
        except (ValueError, RecursionError):
            found = None
        if not isinstance(found, dict):
            raise self._failed(f"{path} is answered with no JSON object")
        return found

    def _get(self, path: str, params: dict[str, str]) -> httpx2.Response:
        """The answer, asked for again where there is none for a while. Raises ProblemError, Refused 502."""
        why = ""
        for pause in (*PAUSES, None):
            try:
                answer = self._client.request("GET", path, params=params)
            except httpx2.HTTPError as error:
                why = _silence(error)
            except (ValueError, LookupError, TypeError, AttributeError):
                raise self._failed(f"{path} is answered with a problem that cannot be read") from None
            except ProblemError as error:
                if error.status in DENIED or error.status < 400:
                    raise self._denied(error, path) from None
                if error.status not in GONE:
                    raise
                why = _reason(error)[1]
            else:
                if answer.status_code == 200:
                    return answer
                raise self._failed(f"{path} is answered with {answer.status_code}")
            if pause is not None:
                self._tell()
                sleep(pause)
        raise self._failed(why)

    def _denied(self, error: ProblemError, path: str) -> Refused:
        """502: the source sends elsewhere; or it asks for a key, or does not take the one it is sent; who gives it
        another one."""
        if error.status < 400:
            return self._failed(f"{path} is answered with {error.status}")
        kept = self._found.source.replace("://", "://KEY@")
        given = f"in {SETTING}, as {kept}"
        if not self._has_key:
            return self._failed(f"it asks for an API key, which the operator of this instance gives {given}")
        why = f"it does not take the API key that it is sent ({_reason(error)[0]})"
        return self._failed(f"{why}; the operator of this instance gives another one {given}")

    def _failed(self, why: str) -> Refused:
        """502: the source; what was done until then."""
        stored = len(self._found.stored)
        kept = f"{stored} parts were stored and stay; " if stored else ""
        detail = f"{self._found.source}: {why}; {kept}try the job again for the rest"
        return Refused(502, "source-failed", detail, stored=stored, same=len(self._found.same))


def _reference(version: Version) -> str:
    return f"{version.name}@{version.version}"


def _silence(error: httpx2.HTTPError) -> str:
    """In words, why there is no answer."""
    if isinstance(error, httpx2.ConnectError):
        return str(error).partition(";")[0]  # how a server is started is for people at one of their own
    return "no answer in time" if isinstance(error, httpx2.TimeoutException) else f"no answer ({error})"


def _reason(error: InvalidInput | ProblemError | Refused) -> tuple[str, str]:
    """Code and message, of another server within bounds."""
    if not isinstance(error, ProblemError):
        known = known_refusal(error)
        return ("invalid-bundle", str(error)) if known is None else (known.code, known.detail)
    code = error.problem.get("code")
    return code[:80] if isinstance(code, str) else "source-failed", str(error)[:500]
