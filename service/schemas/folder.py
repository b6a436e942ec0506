"""Shapes of what is told of the folder that a server follows."""

from __future__ import annotations

from pydantic import Field

from service.schemas.resources import ProblemError
from service.schemas.shapes import Shape, Time


class ReadFile(Shape):
    """A file that was read."""

    file: str = Field(description="relative to the folder")
    part: str
    version: int
    remark: str = Field(description="why the part's latest version is another one; empty where it is not")


class RefusedFile(Shape):
    """A file that cannot be used; what was stored of it before stays."""

    file: str
    part: str | None = Field(description="the part that it describes, or did last; null where that is not known")
    errors: list[ProblemError] = Field(description="messages end with line and column where they are known")


class NotRead(Shape):
    """Files that are no definitions."""

    count: int
    items: list[str] = Field(description="the first 100")


class FolderView(Shape):
    """What was read of a folder."""

    folder: str = Field(description="its name")
    changed: Time | None = Field(description="when anything of this changed last; null while nothing was read")
    files: list[ReadFile]
    refused: list[RefusedFile]
    gone: list[str] = Field(description="parts whose file is gone: their versions are withdrawn")
    waiting: list[str] = Field(description="parts whose file is missing while a folder cannot be read")
    not_read: NotRead
