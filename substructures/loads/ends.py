"""The frames of loads: of parts, a body or port by its name; of trees, ``instance.port``, ``instance.body`` or
``world`` (the HTTP contract, sections 1 and 3).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

from pydantic import Field, TypeAdapter, ValidationError, WithJsonSchema, model_validator
from pydantic_core import PydanticCustomError

from substructures.documents.fields import Name, NumberVector
from substructures.loads.document import Load
from substructures.loads.names import End

NONE: NumberVector = (0, 0, 0)
CoordinateOfTree = Annotated[
    str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]{0,63}\.[A-Za-z][A-Za-z0-9_]{0,63}$", description="instance.coordinate")
]
#: a frame of a tree
AT = r"^(world|[A-Za-z][A-Za-z0-9_]{0,63}\.[A-Za-z][A-Za-z0-9_]{0,63})$"
FrameOfTree = Annotated[str, Field(pattern=AT)]
_FRAME: dict[str, Any] = {"type": "string", "pattern": AT}
_POINT: dict[str, Any] = {"type": "array", "minItems": 3, "maxItems": 3, "items": {}}
_WITH_POINT = {"type": "object", "properties": {"frame": _FRAME, "at": _POINT}, "required": ["frame"]}
#: an end of a load, also as an object with a point of the frame, which is read as the field for that point
PlaceOfTree = Annotated[
    FrameOfTree, WithJsonSchema({"anyOf": [_FRAME, {**_WITH_POINT, "additionalProperties": False}]}, mode="validation")
]
_END = "instance.port, instance.body or world"


class _FromTo(Load):
    """``from`` and ``to``; ``points``: the fields for the points of ends that have some."""

    frames: ClassVar[tuple[str, ...]] = ("from", "to")
    points: ClassVar[Mapping[str, str]] = {}

    from_: str
    to: str

    def ends(self, pointer: str) -> tuple[End, ...]:
        """Both."""
        pairs = (("from", self.from_), ("to", self.to))
        return tuple(
            End(
                frame,
                f"{pointer}/{end}",
                getattr(self, self.points.get(end, ""), ()),
                f"{pointer}/{self.points.get(end)}",
            )
            for end, frame in pairs
        )


class EndsOfPart(_FromTo):
    """``from`` and ``to``: bodies (``base`` among them) or ports."""

    from_: Name = Field("base", alias="from", description="body or port")
    to: Name = Field(description="body or port")


def _fault(code: str, below: str, message: str) -> PydanticCustomError:
    return PydanticCustomError(code, "{message}", {"message": message, "below": below})


_VECTOR: TypeAdapter[NumberVector] = TypeAdapter(NumberVector)


def _point(given: Any, below: str) -> Any:
    """A point as it was given. Raises PydanticCustomError."""
    try:
        _VECTOR.validate_python(given)
    except ValidationError:
        raise _fault("point-expected", below, "three numbers or expressions are needed") from None
    return given


class OfTree(Load):
    """A load of a tree, by its name."""

    name: Name

    def of_part(self, fields: dict[str, Any]) -> dict[str, Any]:
        """The load of the part that the tree becomes; ``fields``: those of this one, with names of the part."""
        return fields


class EndsOfTree(_FromTo, OfTree):
    """``from`` and ``to``: any two frames of a tree."""

    from_: PlaceOfTree = Field("world", alias="from", description=_END)
    to: PlaceOfTree = Field(description=_END)

    @model_validator(mode="before")
    @classmethod
    def _with_points(cls, data: Any) -> Any:
        """``"from": {"frame": "a.tip", "at": [0, 0, 1]}`` as ``"from": "a.tip", "from_at": [0, 0, 1]``."""
        ends = [name for name in ("from", "to") if isinstance(data, Mapping) and isinstance(data.get(name), Mapping)]
        found = dict(data) if ends else data
        for end in ends:
            frame, field = data[end], cls.points.get(end)
            for name in frame:
                if name not in ("frame", "at"):
                    raise _fault("unknown-field", f"/{end}/{name}", f"unknown field '{name[:80]}'")
            if "frame" not in frame:
                raise _fault("frame-missing", f"/{end}", "'frame' is needed")
            if "at" in frame and (field is None or field in data):
                why = "this load acts at no point of that frame" if field is None else f"it is given in '{field}', too"
                raise _fault("no-point", f"/{end}/at", why)
            found[end] = frame["frame"]
            if "at" in frame:
                found[field] = _point(frame["at"], f"/{end}/at")
        return found
