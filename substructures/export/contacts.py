"""Contacts of a tree that is exported to be simulated: what they do beside the formulas of their gaps and rows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from substructures.errors import TooLarge

#: the name of the function of gaps, rows, rates, biases, what acts, and the metric
CONTACTS = "contacts"
#: most contacts of an FMU
MOST = 16
#: outputs of each contact with their units, and of all
OF_EACH = {"gap": "m", "normal_force": "N", "friction_force": "N", "friction_force_y": "N"}
OF_EACH |= {"indicator_1": "", "indicator_2": ""}
OF_ALL = {"impact_energy": "J", "impacts": "", "last_impact": "s"}


class ContactLaw(Protocol):
    """What is needed of a contact of the tree."""

    @property
    def name(self) -> str:
        """As of the tree."""

    @property
    def tangents(self) -> int:
        """1 where it slides along x alone, else 2."""

    @property
    def restitution(self) -> float:
        """Of an impact, 0 to 1."""

    @property
    def friction(self) -> float:
        """Coulomb's coefficient."""

    @property
    def rest_velocity(self) -> float:
        """Along the normal, at which an impact ends with none [m/s]."""


def require_few(contacts: Sequence[ContactLaw]) -> None:
    """Raises TooLarge."""
    if len(contacts) > MOST:
        raise TooLarge("the contacts of an FMU", len(contacts), MOST)
