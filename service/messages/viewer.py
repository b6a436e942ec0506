"""Who asks: an API key with its owner and scopes, and what may be seen and changed with it.

Names belong to owners. A name is ``public`` or ``private``; what is private does not exist for others. What was public
once stays so, for others may have used it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from service.messages.refusals import Refused

SCOPES = ("read", "write", "jobs", "admin")
OPEN = "local"  # key and owner of whoever asks a server without keys
CATALOGUE = "catalogue"  # owner of what is shipped
CONSOLE = "console"  # key of commands that work on the store directly
PUBLIC, PRIVATE = "public", "private"
Visibility = Literal["public", "private"]


@dataclass(frozen=True, slots=True)
class Viewer:
    """``key``: its id; ``scopes``: what it was made for."""

    key: str
    owner: str
    scopes: Sequence[str]

    @property
    def is_admin(self) -> bool:
        """Whether everything may be seen and changed."""
        return "admin" in self.scopes

    def sees(self, owner: str, visibility: str) -> bool:
        """Whether what belongs to an owner is there for this viewer."""
        return visibility == PUBLIC or self.may_change(owner)

    def may_change(self, owner: str) -> bool:
        """Whether what belongs to an owner may be changed."""
        return self.is_admin or owner == self.owner

    def has(self, scope: str) -> bool:
        """Whether this may be done."""
        return scope in self.scopes or self.is_admin

    def require(self, scope: str) -> None:
        """Raise Refused 403 without a scope."""
        if not self.has(scope):
            has = ", ".join(f"'{each}'" for each in self.scopes)
            detail = f"the API key in the header Authorization lacks the scope '{scope}'; it has {has}"
            raise Refused(403, "scope-missing", detail, scope=scope)


#: whoever asks a server without keys: it listens on loopback only
ANYBODY = Viewer(OPEN, OPEN, SCOPES)
#: who sees what is public alone
PUBLIC_ONLY = Viewer("", "", ())
#: who stores what is in the folder of a server
FOLDER = Viewer("folder", OPEN, ("write",))
#: who imports what is shipped
SHIPPED = Viewer(CATALOGUE, CATALOGUE, ("write",))
