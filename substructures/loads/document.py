"""What a load is: a document, and the law that is read of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Protocol

from pydantic import ConfigDict, Field, TypeAdapter, ValidationError, WithJsonSchema, model_validator
from pydantic_core import PydanticCustomError

from substructures.documents.fields import DocumentPart, Name, Number, NumberVector
from substructures.documents.units import Dimension
from substructures.expr.graph import Expr
from substructures.expr.units.unit_check import Place
from substructures.loads.names import Elastic, End, Names
from substructures.loads.pairs import Reach
from substructures.loads.units import DAMPING, LENGTH, STIFFNESS, fields_of, vector

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


@dataclass
class LoadFormulas:
    """What loads do: ``forces`` Q_a by coordinate, ``potential`` V with -d_a V a part of them.

    ``forces.acting``: the forces and moments between frames that they are of; Q_a q'^a is the power of the loads.
    """

    forces: Reach
    potential: Expr

    def add(self, reach: Reach, factor: Expr | None = None) -> None:
        """The forces w_a of a reach, or factor w_a."""
        for a, w in reach.items():
            if factor is None or not w.is_zero:
                Q = w if factor is None else factor * w
                self.forces[a] = self.forces[a] + Q if a in self.forces else Q
        self.forces.acting += reach.acting if factor is None else reach.times(factor)

    def keep(self, energy: Expr) -> None:
        """A part of the potential."""
        self.potential = self.potential + energy


class Law(Protocol):
    """A load whose numbers are read."""

    def acts(self, names: Names, found: LoadFormulas) -> None:
        """Adds its forces and its potential, where the frames have their places; notes faults in the scope of names."""


class Load(DocumentPart):
    """A load of a part or of a tree.

    ``frames``: the fields that name frames, each one or a list, a name or an object with the field ``frame``;
    ``dimensions``: those of its numbers, by field; ``is_elastic``: whether pictures show it, as a spring.
    """

    frames: ClassVar[tuple[str, ...]] = ()
    dimensions: ClassVar[Mapping[str, Dimension]] = {}
    is_elastic: ClassVar[bool] = False

    model_config = ConfigDict(frozen=True, extra="forbid", serialize_by_alias=True)

    @property
    def called(self) -> str:
        """As messages call it: by its type, and in a tree by its name."""
        found = str(self.__dict__["type"])
        return f"{found} '{self.__dict__['name']}'" if "name" in self.__dict__ else found

    def ends(self, pointer: str) -> tuple[End, ...]:
        """The frames that it acts between, with the points in them; ``pointer``: to the load."""
        del pointer
        return ()

    def law(self, names: Names, pointer: str) -> Law | None:
        """The law, read; None after a fault, and of what acts otherwise. ``pointer``: to the load."""
        del names, pointer
        return None

    def places(self, pointer: str, kinds: Mapping[str, int]) -> Iterator[Place]:
        """Its numbers with their dimensions; ``kinds``: 1 of prismatic and 0 of revolute coordinates, by name."""
        del kinds
        yield from fields_of(pointer, self, self.dimensions)
        for end in self.ends(pointer):
            yield from vector(end.at_pointer, end.at, LENGTH)

    def line(self) -> tuple[str, ...]:
        """The frames along which pictures show it."""
        return tuple(end.frame for end in self.ends("")) if self.is_elastic else ()


class ElasticLoad(Load):
    """Springs and dampers along a length."""

    dimensions: ClassVar[Mapping[str, Dimension]] = {"stiffness": STIFFNESS, "damping": DAMPING, "length": LENGTH}
    is_elastic: ClassVar[bool] = True

    stiffness: Number = Field(0, description="N/m")
    damping: Number = Field(0, description="N s/m")
    length: Number = Field(0, description="m; unstretched")

    def read(self, names: Names, pointer: str) -> Elastic | None:
        """Its ends and numbers; None after a fault of an end."""
        ends = [names.end(end) for end in self.ends(pointer)]
        k, c, l0 = (names.read(getattr(self, field), f"{pointer}/{field}") for field in self.dimensions)
        return None if None in ends else Elastic(pointer, ends, (self.stiffness, self.length), k, c, l0)


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
