"""The JSON form of the loads of a tree: what acts between any two of its frames (the HTTP contract, section 3)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import ConfigDict, Field, RootModel, TypeAdapter, ValidationError, WithJsonSchema, model_validator
from pydantic_core import PydanticCustomError

from substructures.documents import DocumentPart
from substructures.documents.fields import BY_TYPE, Name, Number, NumberVector
from substructures.part.definition import FrictionLaw

NONE: NumberVector = (0, 0, 0)
COORDINATE = r"^[A-Za-z][A-Za-z0-9_]{0,63}\.[A-Za-z][A-Za-z0-9_]{0,63}$"
#: a frame of a tree
AT = r"^(world|[A-Za-z][A-Za-z0-9_]{0,63}\.[A-Za-z][A-Za-z0-9_]{0,63})$"
FrameOfTree = Annotated[str, Field(pattern=AT)]
_FRAME: dict[str, Any] = {"type": "string", "pattern": AT}
_POINT: dict[str, Any] = {"type": "array", "minItems": 3, "maxItems": 3, "items": {}}
_WITH_POINT = {"type": "object", "properties": {"frame": _FRAME, "at": _POINT}, "required": ["frame"]}
#: an end of a load, also as an object with a point of the frame, which is read as the field for that point
End = Annotated[
    FrameOfTree, WithJsonSchema({"anyOf": [_FRAME, {**_WITH_POINT, "additionalProperties": False}]}, mode="validation")
]


_END = "instance.port, instance.body or world"


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


class _OfTree(DocumentPart):
    name: Name

    model_config = ConfigDict(frozen=True, extra="forbid", serialize_by_alias=True)


class _Between(_OfTree):
    from_: End = Field("world", alias="from", description=_END)
    to: End = Field(description=_END)

    #: the fields for the points of ends that have some
    points: ClassVar[Mapping[str, str]] = {}

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


class TreeSpring(_Between):
    """A spring and damper between a point of one frame and a point of another: force k (l - length) + c l'."""

    points: ClassVar[Mapping[str, str]] = {"from": "from_at", "to": "to_at"}

    type: Literal["spring"]
    from_at: NumberVector = Field(NONE, description="m; the point in the frame 'from'")
    to_at: NumberVector = Field(NONE, description="m; the point in the frame 'to'")
    stiffness: Number = Field(0, description="N/m")
    damping: Number = Field(0, description="N s/m")
    length: Number = Field(0, description="m; unstretched")


class Bushing(_Between):
    """Springs and dampers along and about the three axes of the frame ``from``, between the origins of both frames.

    d: from the origin of ``from`` to that of ``to``, forces -k_i d_i - c_i d_i' on ``to`` along the axes of ``from``.
    The angular springs have the potential sum_j h_j (1 - e_j . m_j) of the axes e_j of ``from`` and m_j of ``to``, with
    h_j = (k_1 + k_2 + k_3)/2 - k_j: moments -k_i theta_i for small angles.
    """

    type: Literal["bushing"]
    stiffness: NumberVector = Field(NONE, description="N/m; along the three axes")
    damping: NumberVector = Field(NONE, description="N s/m; along the three axes")
    angular_stiffness: NumberVector = Field(NONE, description="N m/rad; about the three axes")
    angular_damping: NumberVector = Field(NONE, description="N m s/rad; about the three axes")


class TreeForce(_Between):
    """A force on ``to`` at a point; the opposite force acts on ``from`` at the same place."""

    points: ClassVar[Mapping[str, str]] = {"to": "at"}

    type: Literal["force"]
    at: NumberVector = Field(NONE, description="m; the point in the frame 'to'")
    vector: NumberVector = Field(description="N")
    axes: Literal["to", "from", "world"] = Field("to", description="in whose axes the vector is")


class TreeTorque(_Between):
    """A free moment on ``to``; the opposite one acts on ``from``."""

    type: Literal["torque"]
    vector: NumberVector = Field(description="N m")
    axes: Literal["to", "from", "world"] = Field("to", description="in whose axes the vector is")


class TreeJointLoad(_OfTree):
    """A generalised force on a coordinate of an instance."""

    type: Literal["joint"]
    coordinate: Annotated[str, Field(pattern=COORDINATE)] = Field(description="instance.coordinate")
    force: Number = Field(description="N m or N")


class TreeFriction(FrictionLaw):
    """Dry friction of a coordinate of an instance, as the field ``friction`` of its joint; a coordinate has one."""

    name: Name
    type: Literal["friction"]
    coordinate: Annotated[str, Field(pattern=COORDINATE)] = Field(description="instance.coordinate")


class TreePotential(_OfTree):
    """Forces by their potential V in coordinates, measures of frames, parameters, inputs and t: Q_a = -dV/dq^a."""

    type: Literal["potential"]
    potential: Number = Field(description="J")


TreeLoad = Annotated[
    TreeSpring | Bushing | TreeForce | TreeTorque | TreeJointLoad | TreePotential | TreeFriction,
    Field(discriminator="type"),
    BY_TYPE,
]


class AnyTreeLoad(RootModel[TreeLoad]):
    """One load of a tree, by its type."""
