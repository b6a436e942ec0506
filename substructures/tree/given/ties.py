"""What holds along the motions of a tree beside its closures: velocity constraints, and contacts."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from decimal import Decimal
from typing import Annotated, Any, Literal, Protocol

from pydantic import Field

from substructures.documents import DocumentPart
from substructures.documents.fields import BY_TYPE, Name, Number, PlainNumber, in_si
from substructures.errors import InvalidDocument

MAX_CONTACTS = 20


def plain_number(x: Any) -> Any:
    """A decimal as a text."""
    return format(x, "f") if isinstance(x, Decimal) else str(x)


FrameName = Annotated[str, Field(max_length=140, description="instance.port or instance.body")]


class Tie(DocumentPart):
    """One by its name."""

    name: Name

    def plain(self) -> dict[str, Any]:
        """What was given but defaults, numbers in SI as texts."""
        given: dict[str, Any] = {name: getattr(self, name) for name in self.model_dump(exclude_defaults=True)}
        return {
            name: [plain_number(x) for x in value] if isinstance(value, tuple) else plain_number(in_si(value))
            for name, value in given.items()
        }


class LinearConstraint(Tie):
    """An expression that is zero, affine in the velocities: B(q) q' + b(q, t), b what a table or a belt gives."""

    type: Literal["linear"]
    expression: str


class KnifeEdgeConstraint(Tie):
    """A skate: no velocity across the edge, which lies along the first axis of the frame."""

    type: Literal["knife_edge"]
    frame: FrameName


class RollingConstraint(Tie):
    """A disc (axis: third axis of the frame) or a sphere that rolls on a plane without slip."""

    type: Literal["rolling"]
    frame: FrameName
    radius: Number = Field(description="m")
    shape: Literal["disc", "sphere"] = "disc"
    normal: tuple[PlainNumber, PlainNumber, PlainNumber] = Field(
        (0, 0, 1), description="of the plane in the world (constant)"
    )


#: what they mean: substructures.analysis.equations.nonholonomic
ConstraintOfTree = Annotated[
    LinearConstraint | KnifeEdgeConstraint | RollingConstraint, Field(discriminator="type"), BY_TYPE
]


class ContactOfTree(Tie):
    """A point that does not pass through a plane: the origin of a frame, and z = 0 of the world or x, y of a frame."""

    type: Literal["point_plane", "point_line"] = Field("point_plane", description="point_line: slides along x alone")
    point: FrameName
    plane: Annotated[str, Field(max_length=140)] = Field("world", description="or a frame, whose z axis is the normal")
    restitution: PlainNumber = Field(0, description="0 to 1")
    friction: PlainNumber = Field(0, description="Coulomb's coefficient")
    when: Annotated[str, Field(max_length=10_000)] | None = Field(
        None, description="one comparison: else the point passes the plane"
    )
    rest_velocity: Number | None = Field(None, description="m/s; slower ones do not rebound (1e-4)")


class Tied(Protocol):
    """A tree or its model."""

    @property
    def velocity_constraints(self) -> Sequence[Any]:
        """As in the document, or as plain data."""

    @property
    def contacts(self) -> Sequence[Any]:
        """As in the document, or as plain data."""


ORBITS = ("periodic-orbits", "poincare-sections", "lyapunov-exponents")
#: what takes ball and floating joints, whose rates are no derivatives of coordinates
TAKES_BALLS = (
    *("simulations", "TreeMotion", "forward_dynamics", "reactions", "linearisations", "perturbation", "state_space"),
    *("frequency-responses", "regulators", "equilibria", "root-loci", "ensembles", "sensitivities"),
    *("parameter_sensitivity", "equivalences", "columns of equilibria and linearisations", "columns of reach"),
    *("optimal-parameters", "first_integrals", "optimal-controls", "cost-gradients", "adjoint", *ORBITS),
    *("steady-motions", "base_parameters", "base_regressor", "excitations", "identifications"),
)

#: what takes the velocity constraints of a tree, and its contacts
TAKES_CONSTRAINTS = (
    *("simulations", "linearisations", "velocity-equations", "equilibria", "steady-motions", "first_integrals"),
    *("ensembles", "sensitivities", "root-loci", "optimal-parameters", "perturbation", "parameter_sensitivity"),
    *("velocity_dynamics", "frequency-responses", "optimal-controls", "cost-gradients", "adjoint", *ORBITS),
    *("regulators", "state_space", "excitations", "identifications"),
)
TAKES_CONTACTS = ("simulations", "ensembles", "sweep")
#: with the kind of motion that has them
TIES = {
    "velocity_constraints": (TAKES_CONSTRAINTS, "ConstrainedMotion"),
    "contacts": (TAKES_CONTACTS, "TreeMotion"),
}


def require_chains(balls: Collection[Any], instead: str = "", pointer: str = "") -> None:
    """Raises InvalidDocument (``has-balls``) where joints without singular angles are not taken into account."""
    if balls:
        message = (
            "rates of ball and floating joints, which are no derivatives of coordinates, are not taken into account"
        )
        instead = f"{instead}, or " if instead else ""
        advice = f"{instead}take the joint types 'spherical' and 'free', which have coordinates"
        raise InvalidDocument.at(pointer, "has-balls", f"{message} here: {advice}")


def names_of(ties: Sequence[Any]) -> list[str]:
    """Their names."""
    return [str(each["name"] if isinstance(each, Mapping) else each.name) for each in ties]


def require_untied(tree: Tied, what: str) -> None:
    """Raises InvalidDocument (``has-velocity-constraints``, ``has-contacts``, ``has-balls``) where ``what`` would not
    know them.
    """
    require_chains(getattr(tree, "balls", ()) if what not in TAKES_BALLS else ())
    for field, (takes, motion) in TIES.items():
        names = ", ".join(f"'{name}'" for name in names_of(getattr(tree, field)))
        if names and what not in (*takes, motion):
            kind = field.replace("_", " ")
            message = (
                f"the tree has the {kind} {names}, which '{what}' does not take into account: take "
                f"{', '.join(takes)}, or the tree without '{field}'"
            )
            raise InvalidDocument.at("", f"has-{kind.replace(' ', '-')}", message)
