"""A client of the HTTP interface, for Python programs; it knows nothing of how the service is made.

Answers are dictionaries whose members are attributes, too (:class:`Answer` and its kinds). Notebooks show formulas as
mathematics, parts and trees as pictures; ``quickstart.ipynb`` beside this file begins with a part of one's own.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from substructures.late import names_in

if TYPE_CHECKING:  # what is imported when it is first asked for: most commands talk to no server
    from substructures.client.answers import Answer, Page
    from substructures.client.catalogue import Version
    from substructures.client.client import Client, ProblemError, ServerLost
    from substructures.client.jobs import Job
    from substructures.client.numbers import Evaluation, Motion
    from substructures.client.trees import Tree
    from substructures.display import Formula, Picture
    from substructures.formats.logs import log_of
    from substructures.formats.packing import unpack

__all__ = [
    "Answer",
    "Client",
    "Evaluation",
    "Formula",
    "Job",
    "Motion",
    "Page",
    "Picture",
    "ProblemError",
    "ServerLost",
    "Tree",
    "Version",
    "log_of",
    "unpack",
]

__getattr__ = names_in(
    __name__,
    {
        "substructures.client.answers": (
            "Answer",
            "Page",
        ),
        "substructures.client.catalogue": ("Version",),
        "substructures.client.client": (
            "Client",
            "ProblemError",
            "ServerLost",
        ),
        "substructures.client.jobs": ("Job",),
        "substructures.client.numbers": (
            "Evaluation",
            "Motion",
        ),
        "substructures.client.trees": ("Tree",),
        "substructures.display": (
            "Formula",
            "Picture",
        ),
        "substructures.formats.logs": ("log_of",),
        "substructures.formats.packing": ("unpack",),
    },
)
