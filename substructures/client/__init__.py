"""A client of the HTTP interface, for Python programs; it knows nothing of how the service is made.

Answers are dictionaries whose members are attributes, too (:class:`Answer` and its kinds). Notebooks show formulas as
mathematics, parts and trees as pictures; ``quickstart.ipynb`` beside this file begins with a part of one's own.
"""

from substructures.client.answers import Answer, Page
from substructures.client.catalogue import Version
from substructures.client.client import Client, ProblemError, ServerLost
from substructures.client.jobs import Job
from substructures.client.numbers import Evaluation, Motion
from substructures.client.trees import Tree
from substructures.display import Formula, Picture
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
    "unpack",
]
