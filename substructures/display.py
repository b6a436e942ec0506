"""Texts that notebooks show as what they mean: formulas as mathematics, SVG as pictures. They remain plain texts."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Self


class Formula(str):
    """A formula as text; notebooks show it as mathematics where there is LaTeX of it.

    ``latex`` gives the inside of display mathematics, as ``format=latex`` does, and is asked once, when the formula is
    shown; without it, and where it fails, the text is shown.
    """

    _latex: Callable[[], str] | None
    _shown: str | None

    def __new__(cls, text: str, latex: Callable[[], str] | None = None) -> Self:
        """The text, with what gives its LaTeX."""
        made = super().__new__(cls, text)
        made._latex, made._shown = latex, None
        return made

    def __reduce__(self) -> tuple[type[str], tuple[str]]:
        """Copies are plain texts."""
        return str, (str(self),)

    def _repr_latex_(self) -> str | None:
        if self._latex is not None:
            try:
                self._shown = mathematics(self._latex())
            except Exception:  # whatever hinders it: the text is still there
                self._shown = None
            self._latex = None
        return self._shown

    def _repr_mimebundle_(self, **_: Any) -> dict[str, str]:
        latex = self._repr_latex_()
        return {"text/plain": str(self), **({"text/latex": latex} if latex else {})}

    def _repr_pretty_(self, printer: Any, _cycle: bool) -> None:
        printer.text(str(self))  # otherwise IPython shows it as any text, in one line between quotes


def shown(text: str, format: str, latex: Callable[[], str]) -> Formula:  # noqa: A002 -- the name in the contract
    """A formula in a format: ``text`` and ``latex`` are shown as mathematics, others as they are."""
    return Formula(text, {"text": latex, "latex": lambda: text}.get(format))


def mathematics(latex: str) -> str:
    """LaTeX as display mathematics of a notebook, without the comments that explain its symbols."""
    lines = [line for line in latex.splitlines() if line.strip() and not line.startswith("%")]
    return "\n".join(["$$", *lines, "$$"])


class Picture(str):
    """SVG as text; notebooks show the picture."""

    __slots__ = ()

    def _repr_svg_(self) -> str:
        return str(self)

    def _repr_mimebundle_(self, **_: Any) -> dict[str, str]:
        return {"text/plain": self._words(), "image/svg+xml": str(self)}

    def _repr_pretty_(self, printer: Any, _cycle: bool) -> None:
        printer.text(self._words())

    def _words(self) -> str:
        return f"a picture (SVG, {len(self):,} characters)"
