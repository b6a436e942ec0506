"""Evaluations in the format of the request and of the answer: JSON, npz, Arrow."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import chain
from typing import Any

from service.messages.answers import JSON, Answer, Stream, json_answer, streamed
from service.messages.negotiation import most_wanted
from service.messages.refusals import Refused
from service.messages.spool import Spool
from service.operations import evaluations
from service.operations.jobs import batches
from service.schemas import forms
from service.schemas.numbers import EvaluationRequest
from service.settings import Limits
from substructures.documents import read_json
from substructures.documents.grouped import take
from substructures.formats import arrays, arrow
from substructures.quantities.accelerations import Evaluator
from substructures.quantities.numbers.evaluation import EvaluationOptions, evaluate, evaluate_in_parts
from substructures.quantities.numbers.result import Evaluation
from substructures.quantities.numbers.states import longest
from substructures.quantities.sources import Sources

MEDIA_TYPES = (JSON, arrays.MEDIA_TYPE, arrow.MEDIA_TYPE)
PART = 4 * 2**20  # bytes of results that are computed, and then sent, at a time
WHOLE = 16  # parts that an npz answer may have to be made in one piece, which is quicker where there are few cores
_KNOWN = ", ".join(MEDIA_TYPES)
_EXTRA = "this server has no Arrow: install it with the extra 'substructures[arrow]', or use application/x-npz"


def choose_media_type(accept: str, sent: str) -> str:
    """The media type of the answer; that of the request if all are welcome. Raises Refused 406."""
    if accept in ("*/*", sent) and sent in (JSON, arrays.MEDIA_TYPE):
        return sent
    found = most_wanted(accept, [media for media in (sent, *MEDIA_TYPES) if media in MEDIA_TYPES])
    if found is None:
        raise Refused(406, "not-acceptable", f"answers are {_KNOWN}")
    if found == arrow.MEDIA_TYPE and not arrow.is_available():
        raise Refused(406, "arrow-not-installed", _EXTRA)
    return found


def read_requests(body: Spool, sent: str, limits: Limits) -> Iterable[EvaluationRequest]:
    """The request, or the requests for one batch of states after the other. Raises InvalidDocument, Refused 415."""
    file = body.reader()
    if sent == arrays.MEDIA_TYPE:
        return [batches.npz_request(file, limits)]
    if sent == arrow.MEDIA_TYPE:
        if not arrow.is_available():
            raise Refused(415, "arrow-not-installed", _EXTRA)
        return batches.arrow_requests(file, limits)
    if sent == JSON:
        return [EvaluationRequest.read(read_json(forms.unpacked(file.read())))]
    received = f"Content-Type '{sent[:80]}'" if sent else "no Content-Type"
    detail = f"send {_KNOWN}; {received} was received"
    raise Refused(415, "unsupported-media-type", detail, headers={"Accept": _KNOWN})


@dataclass(frozen=True, slots=True)
class TreeEvaluation:
    """Evaluates a tree in the format wanted."""

    sources: Sources
    digest: str
    limits: Limits
    evaluator: Evaluator

    def answer(self, requests: Iterable[EvaluationRequest], wanted: str) -> Answer | Stream:
        """The answer to requests. Raises InvalidInput, MissingValue, TooLarge, all before the first byte is sent
        unless the requests come one by one.
        """
        if wanted == arrow.MEDIA_TYPE:
            return streamed(self._arrow(iter(requests)), wanted)
        return self.whole(batches.joined(self.sources.model, requests, self.limits), wanted)

    def whole(self, request: EvaluationRequest, wanted: str) -> Answer | Stream:
        """The answer to one request in one piece, as JSON or npz. Raises as :meth:`answer`."""
        arguments = request.arguments()
        evaluations.check_size(self.sources, request.quantities, longest(arguments), self.limits)
        return self._npz(arguments) if wanted == arrays.MEDIA_TYPE else self.json(arguments)

    def _npz(self, arguments: Mapping[str, Any]) -> Answer | Stream:
        """The answer as npz: as a whole where it is small, otherwise sent while it is computed."""
        count = longest(arguments)
        if count <= WHOLE * self._size_of_part(arguments):
            file = arrays.as_npz(self._evaluated(arguments).plain(self.digest))
            return Stream(iter(file.pieces), {"Content-Type": arrays.MEDIA_TYPE, "Content-Length": str(file.size)})
        parts = self._in_parts(arguments, told_first=True)
        names = list(dict.fromkeys(arguments["quantities"]))
        return streamed(arrays.npz_parts(parts, names, count), arrays.MEDIA_TYPE)

    def json(self, arguments: Mapping[str, Any]) -> Answer:
        """The answer to arguments of a size that was checked, as JSON. Raises InvalidInput, MissingValue."""
        return json_answer(evaluations.as_json(self._evaluated(arguments), self.digest))

    def _arrow(self, requests: Iterator[EvaluationRequest]) -> Iterator[memoryview | bytes]:
        first = next(requests)
        return batches.as_arrow(self._batches(chain([first], requests)), first.quantities)

    def _batches(self, requests: Iterable[EvaluationRequest]) -> Iterator[Iterator[dict[str, Any]]]:
        """The answers to each request, whose states are counted on."""
        done = 0
        for request in requests:
            arguments = request.arguments()
            states = longest(arguments)
            evaluations.check_size(self.sources, request.quantities, states, self.limits, streamed=True)
            yield self._in_parts(arguments, done)
            done += states

    def _in_parts(
        self, arguments: Mapping[str, Any], first: int = 0, told_first: bool = False
    ) -> Iterator[dict[str, Any]]:
        """The answer part by part. What is wrong with the arguments is raised at once."""
        parts = evaluate_in_parts(
            self.sources,
            arguments["quantities"],
            arguments,
            self._size_of_part(arguments),
            limit=self.limits.states,
            evaluator=self.evaluator,
            first=first,
            told_first=told_first,
        )
        return (part.plain(self.digest) for part in parts)

    def _size_of_part(self, arguments: Mapping[str, Any]) -> int:
        """States."""
        return max(1, PART // evaluations.bytes_per_state(self.sources, arguments["quantities"]))

    def _evaluated(self, arguments: Mapping[str, Any], first: int = 0) -> Evaluation:
        given = {**arguments, "limit": self.limits.states, "evaluator": self.evaluator, "first": first}
        return evaluate(self.sources, options=take(EvaluationOptions, given), **given)
