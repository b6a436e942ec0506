"""Pictures of parts and trees in one pose, as SVG, and what they are drawn of; those in the standard pose are kept."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

import orjson

from service.jobs.worker import Worker
from service.messages.answers import Answer
from service.messages.refusals import unprocessable
from service.operations.modules import Subject, kept, made
from service.queries.trees import Tree
from service.schemas.scenes import LARGEST
from substructures.documents.fields import Quantity, quantity_of
from substructures.errors import InvalidArgument
from substructures.mechanics.state_names import state_units
from substructures.quantities.measured import si_values

PoseValues = tuple[float, ...]
_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")


def units_of(tree: Tree) -> Sequence[str]:
    """The SI units of the numbers of a tree's states."""
    told = orjson.loads(tree.summary)
    return list(state_units(told["coordinates"], told["joints"], told.get("balls", ()))["q"].values())


def read_pose(text: str | None, units: Sequence[str]) -> PoseValues | None:
    """The pose of ``?q=0.1,30 deg``; None for the standard one. Raises Refused 422 with the pointer ``/query/q``.

    ``units``: in SI, of all of its numbers, empty of quaternions.
    """
    if text is None:
        return None
    fields = [field.strip() for field in text.split(",")] if text.strip() else []
    if len(fields) != len(units):
        raise unprocessable("q", f"expected {len(units)} comma separated numbers, found {len(fields)}", "/query/q")
    return tuple(_coordinate(field, unit) for field, unit in zip(fields, units, strict=True))


def _coordinate(field: str, unit: str) -> float:
    """A number in rad or m, or one with its unit."""
    given = quantity_of(field)
    number = str(given.value) if isinstance(given, Quantity) else given
    value = math.nan
    if _NUMBER.fullmatch(number) and math.isfinite(float(number)):
        try:
            plain = {"value": float(number), "unit": given.unit} if isinstance(given, Quantity) else float(number)
            value = si_values(plain, unit or "1", "/query/q")
        except InvalidArgument as error:
            (fault,) = error.faults
            raise unprocessable(fault.code, f"'{field[:40]}': {fault.message}", "/query/q") from None
    if not abs(value) <= LARGEST:
        detail = f"'{field[:40]}' is no number between -{LARGEST:g} and {LARGEST:g} (rad or m)"
        raise unprocessable("q", detail, "/query/q")
    return value


def picture(subject: Subject, worker: Worker, pose: PoseValues | None) -> bytes:
    """SVG; a tree comes with its parts. Raises TooLarge, TimeoutError."""

    def make() -> bytes:
        """In one pose."""
        return made(subject, worker, "picture", q=None if pose is None else list(pose))["svg"]

    return make() if pose is not None else kept(subject, lambda: Answer(200, make(), {}), "picture").body


def scene(subject: Subject, worker: Worker) -> bytes:
    """What there is to draw, as JSON. Raises as :func:`picture`."""
    return kept(subject, lambda: Answer(200, made(subject, worker, "scene")["json"], {}), "scene").body
