"""Which output format a client wants: ``?format=`` or ``Accept``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from service.messages.refusals import Refused, unprocessable
from substructures.errors import meant
from substructures.export.render import FORMATS
from substructures.printers import FORMS

JSON = "json"
MEDIA_TYPES = dict(FORMATS)


def choose_format(wanted: str | None, accept: str, offered: Mapping[str, str] = MEDIA_TYPES) -> str:
    """The format's name. Raises Refused 422 for an unknown ``format``, 406 when nothing acceptable can be had."""
    known = ", ".join(f"{name} ({media})" for name, media in offered.items())
    if wanted is not None:
        if wanted not in offered:
            there = meant(wanted, offered) or f"; there are {known}"
            raise unprocessable("format", f"unknown format '{wanted[:40]}'{there}", "/query/format")
        return wanted
    for pattern in by_preference(accept or "*/*"):
        for name, media in offered.items():
            if _matches(pattern, media.partition(";")[0]):
                return name
    raise Refused(406, "not-acceptable", f"none of these formats is acceptable: {known}")


def choose_media_type(accept: str, offered: Sequence[str]) -> str:
    """One of the media types offered, the first when all are welcome. Raises Refused 406."""
    for pattern in by_preference(accept or "*/*"):
        for media in offered:
            if _matches(pattern, media):
                return media
    raise Refused(406, "not-acceptable", f"answers are {', '.join(offered)}")


def choose_form(wanted: str) -> str:
    """One of FORMS. Raises Refused 422."""
    if wanted not in FORMS:
        there = f"; there are {', '.join(FORMS)}{meant(wanted, FORMS)}"
        raise unprocessable("form", f"unknown form '{wanted[:40]}'{there}", "/query/form")
    return wanted


def by_preference(accept: str) -> list[str]:
    """The media types of an Accept header, the most wanted first; what is not acceptable is left out."""
    weighted = []
    for item in accept.split(","):
        pattern, *parameters = (field.strip().lower() for field in item.split(";"))
        quality = next((p[2:] for p in parameters if p.startswith("q=")), "1")
        try:
            weighted.append((-float(quality), pattern))
        except ValueError:
            continue
    return [pattern for weight, pattern in sorted(weighted, key=lambda pair: pair[0]) if weight < 0]


def _matches(pattern: str, media: str) -> bool:
    return pattern in ("*/*", media) or (pattern.endswith("/*") and media.startswith(pattern[:-1]))
