"""Answers of the service: dictionaries with all that was answered, whose members are attributes, too."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, Generic, TypeVar, overload

import numpy as np

from substructures.display import Picture

Kind = TypeVar("Kind")
NUMBERS = frozenset((int, float))


class Answer(dict[str, Any]):
    """What was answered: ``answer["name"]`` and ``answer.name`` are the same.

    Annotations of its kinds are what is known to this version of the client; members that a newer service adds are
    there as well, and what an older one leaves out raises AttributeError. Copies are plain dictionaries.
    """

    def __getattr__(self, name: str) -> Any:
        """A member of the answer."""
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"'{name}' is not in this answer: {', '.join(self)}") from None

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *(name for name in self if name.isidentifier())})

    def __reduce__(self) -> tuple[type[dict[str, Any]], tuple[dict[str, Any]]]:
        """Copies are plain dictionaries, without connections to a server."""
        return dict, (dict(self),)


class Drawn(Answer):
    """An answer of which the service has a picture, ``draw``, which is asked for once."""

    def __init__(self, told: Mapping[str, Any], draw: Callable[[Sequence[float] | None], Picture]) -> None:
        super().__init__(told)
        self._draw = draw
        self._drawn: Picture | None = None
        self._is_asked = False

    def picture(self, q: Sequence[float] | None = None) -> Picture:
        """SVG in a pose, or in one that shows its joints. Raises ProblemError."""
        return self._draw(q)

    def _repr_svg_(self) -> str | None:
        if not self._is_asked:
            self._is_asked = True
            try:
                self._drawn = self._draw(None)
            except Exception:  # whatever hinders it: the text is still there
                self._drawn = None
        return self._drawn

    def _repr_mimebundle_(self, **_: Any) -> dict[str, str]:
        svg = self._repr_svg_()
        return {"text/plain": repr(self), **({"image/svg+xml": str(svg)} if svg else {})}


class Page(Sequence[Kind], Generic[Kind]):
    """One page of a list: a sequence of its items. ``told``: all else that was answered, as ``facets``."""

    def __init__(self, items: Sequence[Kind], told: Mapping[str, Any]) -> None:
        self._items, self.told = items, Answer(told)

    @overload
    def __getitem__(self, index: int) -> Kind: ...

    @overload
    def __getitem__(self, index: slice) -> Sequence[Kind]: ...

    def __getitem__(self, index: int | slice) -> Kind | Sequence[Kind]:
        """An item, or some."""
        return self._items[index]

    def __len__(self) -> int:
        return len(self._items)

    def __iter__(self) -> Iterator[Kind]:
        return iter(self._items)

    def __repr__(self) -> str:
        return f"Page: {len(self)} items{', more behind them' if self.next_page_token else ''}"

    @property
    def next_page_token(self) -> str | None:
        """What asks for the next page, if there is one."""
        return self.told.get("next_page_token")


def plain(value: Any) -> Any:
    """Plain data for JSON of what may have arrays and numbers of NumPy anywhere."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, Mapping):
        return {name: plain(item) for name, item in value.items()}
    if isinstance(value, list | tuple) and not NUMBERS.issuperset(map(type, value)):
        return [plain(item) for item in value]
    return value
