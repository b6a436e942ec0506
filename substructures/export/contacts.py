"""Contacts of a tree that is exported to be simulated: what they do beside the formulas of their gaps and rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from substructures.errors import InvalidArgument, TooLarge

#: the name of the function of gaps, rows, rates, biases, what acts, and the metric
CONTACTS = "contacts"
#: most contacts of an FMU
MOST = 16
#: outputs of each contact with their units, and of all
OF_EACH = {"gap": "m", "normal_force": "N", "friction_force": "N", "indicator_1": "", "indicator_2": ""}
OF_ALL = {"impact_energy": "J", "impacts": "", "last_impact": "s"}


@dataclass(frozen=True)
class ContactLaw:
    """Of one contact: its numbers, as of the tree; ``is_line``: whether it slides along x alone."""

    name: str
    is_line: bool
    restitution: float
    friction: float
    rest_velocity: float


def require_planar(contacts: Sequence[ContactLaw]) -> None:
    """Raises InvalidArgument (``/target``) for a point that rubs in two directions, TooLarge."""
    if len(contacts) > MOST:
        raise TooLarge("the contacts of an FMU", len(contacts), MOST)
    for each in contacts:
        if each.friction and not each.is_line:
            message = (
                f"the contact '{each.name}' rubs in two directions, which an FMU does not follow: take the type "
                "'point_line', leave its friction out, or simulate it here"
            )
            raise InvalidArgument.at("/target", "not-supported", message)
