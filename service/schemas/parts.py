"""Parts of requests that the science has a type for."""

from __future__ import annotations

from abc import abstractmethod

from substructures.documents import DocumentPart


class RequestPart(DocumentPart):
    """A part of a request, as plain data, of something that the science takes as a value of its own."""

    @abstractmethod
    def value(self) -> object:
        """As the science takes it. Raises InvalidArgument."""
