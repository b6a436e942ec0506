"""Formulas and pictures of parts and trees, as notebooks show them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from substructures.client.connection import query
from substructures.client.jobs import JobCaller
from substructures.display import Formula, Picture, shown


class PictureCaller(JobCaller):
    """What is to be looked at."""

    def _formula(
        self,
        path: str,
        format: str,  # noqa: A002 -- the name in the contract
        options: Mapping[str, Any],
        method: str = "GET",
        body: Any = None,
    ) -> Formula:
        """A formula in a format. Text and LaTeX are shown as mathematics; the LaTeX of a text is asked for then."""

        def text(format: str) -> str:  # noqa: A002 -- the name in the contract
            """The answer in a format."""
            answer = self.request(method, path + query({"format": format, **options}), body)
            return self.content_of(answer).decode()

        return shown(text(format), format, lambda: text("latex"))

    def _picture(self, path: str, q: Sequence[float] | None) -> Picture:
        pose = None if q is None else ",".join(str(x) for x in q)
        return Picture(self.request("GET", f"{path}/picture" + query({"q": pose})).text)
