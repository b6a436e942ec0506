"""Exceptions: one base for what is given wrongly, and faults that can be moved."""

from __future__ import annotations

import pytest

from service.messages.refusals import known_refusal
from substructures.errors import Fault, InvalidArgument, InvalidDocument, InvalidInput
from substructures.quantities.derivatives import SingularMetric


@pytest.mark.parametrize("kind", [InvalidArgument, InvalidDocument, SingularMetric])
def test_moved_faults_keep_their_kind(kind: type[InvalidInput]) -> None:
    error = kind.at("/q/0/1", "number-expected", "a number is needed").below("/request")
    assert type(error) is kind
    assert error.faults == (Fault("/request/q/0/1", "number-expected", "a number is needed"),)
    assert str(error.moved(lambda _: "")) == "/: a number is needed"


@pytest.mark.parametrize("kind", [InvalidArgument, InvalidDocument])
def test_the_service_shows_arguments_as_it_shows_documents(kind: type[InvalidInput]) -> None:
    refused = known_refusal(kind([Fault("/q", "missing", "states 'q' are needed")]))
    assert refused is not None
    assert (refused.status, refused.code, refused.detail) == (422, "invalid-document", "/q: states 'q' are needed")
    assert [fault.pointer for fault in refused.faults] == ["/q"]
