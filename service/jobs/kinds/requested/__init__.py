"""What requests let runners compute beside what jobs are made of: files are read, trees become parts, and what is to be
read by people is written. No submission names these kinds; their items come from the service itself.
"""

from __future__ import annotations

from collections.abc import Callable

from service.jobs.engines.engine import Outcome
from service.jobs.kinds.kind import Blobs
from service.schemas.jobs import ItemDocument
from substructures.late import Table

Requested = Callable[[ItemDocument, Blobs], Outcome]
_MODULES = {
    "import": "imported",
    "preview": "previewed",
    "publish": "publication",
    "print-part": "printed",
    "report": "reported",
    "difference": "reported",
    "program": "shown",
    "origins": "shown",
    "entry": "shown",
    "integrals": "shown",
    "picture": "drawn",
    "scene": "drawn",
    "derived": "derived",
    "renew-part": "renewed",
    "renew-tree": "renewed",
}
REQUESTED: Table[Requested] = Table("REQUESTED", {name: f"{__name__}.{module}" for name, module in _MODULES.items()})
