"""Contacts that only press: a point of a body on a plane, or on a line of a planar mechanism."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from substructures.analysis.arguments import in_range, one_of, positive
from substructures.errors import InvalidArgument, InvalidInput, listed
from substructures.tree.given.ties import names_of
from substructures.tree.model import Model

#: rows across the normal
TANGENTS = {"point_plane": 2, "point_line": 1}
WORLD = "world"
NUMBERS = ("restitution", "friction", "rest_velocity")
#: largest coefficient of friction
ROUGHEST = 1e3


@dataclass(frozen=True)
class Contact:
    """The origin of the frame ``point`` does not pass through a ``plane``; both are instance.port or instance.body.

    ``plane``: ``world`` (z = 0, on which bodies are above), or a frame: its x and y axes span the plane, its z axis is
    the normal. A ``point_line`` moves in the plane of x and z, and slides along x. ``restitution`` e (0 to 1): an
    impact ends with -e times the velocity that it began with along the normal; slower than ``rest_velocity`` [m/s] it
    ends with none. ``friction``: Coulomb's coefficient. ``when`` (``leg.q1 > 0``): a point that comes to the plane
    while this does not hold passes through it, and acts again once it has come back. Raises InvalidArgument.
    """

    name: str
    point: str
    plane: str = WORLD
    type: Literal["point_plane", "point_line"] = "point_plane"
    restitution: float = 0.0
    friction: float = 0.0
    when: str | None = None
    rest_velocity: float = 1e-4

    def __post_init__(self) -> None:
        one_of(self.type, "type", tuple(TANGENTS))
        object.__setattr__(self, "restitution", in_range(self.restitution, "restitution", 0, 1))
        object.__setattr__(self, "friction", in_range(self.friction, "friction", 0, ROUGHEST))
        object.__setattr__(self, "rest_velocity", positive(self.rest_velocity, "rest_velocity"))
        if self.point == self.plane:
            message = f"'{self.point}' cannot touch itself: name a frame of another body, or '{WORLD}'"
            raise InvalidArgument.at("/plane", "same-frame", message)

    @property
    def tangents(self) -> int:
        """How many directions it slides along."""
        return TANGENTS[self.type]


def contacts_of(model: Model, given: Sequence[Contact] = ()) -> tuple[Contact, ...]:
    """The contacts of a motion: those of the tree, or those that are ``given``.

    Raises InvalidArgument (``/contacts/i/...``) for contacts of the tree that are none, and (``has-contacts``) for
    others beside them.
    """
    own = tuple(_of_tree(each, f"/contacts/{i}") for i, each in enumerate(model.contacts))
    if not own or tuple(given) in ((), own):
        return own or tuple(given)
    message = f"the tree has the contacts {listed(names_of(model.contacts))}: leave 'contacts' out"
    raise InvalidArgument.at("/contacts", "has-contacts", message)


def _of_tree(plain: Mapping[str, Any], pointer: str) -> Contact:
    try:
        fields: dict[str, Any] = {name: float(x) if name in NUMBERS else x for name, x in plain.items()}
        return Contact(**fields)
    except InvalidInput as error:
        raise error.moved(lambda place: f"{pointer}{place}") from None
    except ValueError:
        message = "restitution, friction and rest_velocity of a contact are numbers"
        raise InvalidArgument.at(pointer, "number-expected", message) from None
