"""Stored formulas of a part that was derived here, as text or as a function of a language."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from substructures.export import interface_of_part, render
from substructures.part.outputs import with_own_inertia
from substructures.part.part import OF_FRAMES, Part


def shown(part: Part, quantity: str, format_: str, name: str) -> str:
    """A stored quantity in a format. Raises ValueError for one that the part has not, TooLarge."""
    names = [n for n in part.program.outputs if n == quantity or n.startswith(f"{quantity}.")]
    if not names:
        raise ValueError(f"there is no quantity '{quantity}'; there are {', '.join(part.program.outputs)}")
    program, interface = with_own_inertia(part, part.program.select(names)), interface_of_part(part)
    text = render(program, format_, name=name, interface=interface, quantity=quantity)
    return "".join(_numbered(part, names)) + text if format_ == "text" else text


def _numbered(part: Part, names: Sequence[str]) -> Iterator[str]:
    """What the leading indices of quantities stand for, as comments."""
    known = {"frame": part.frames, **{axis: part.labels(axis) for axis in ("joint", "mover", "port", "coordinate")}}
    axes = dict.fromkeys(axis for name in names for axis in part.axes_of(name) or OF_FRAMES.get(name, ()))
    for axis in axes:
        if labels := known.get(axis):
            of = " carry" if axis in ("joint", "mover") else ""
            yield f"# {axis}s{of}: {', '.join(f'{k} {label}' for k, label in enumerate(labels, 1))}\n"
