"""Which output format a client wants: ``?format=`` or ``Accept``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress

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
    of_media: dict[str, str] = {}
    for name, media in offered.items():
        of_media.setdefault(media.partition(";")[0], name)
    if (found := most_wanted(accept, list(of_media))) is not None:
        return of_media[found]
    raise Refused(406, "not-acceptable", f"none of these formats is acceptable: {known}")


def choose_media_type(accept: str, offered: Sequence[str]) -> str:
    """One of the media types offered, the first when all are welcome. Raises Refused 406."""
    if (found := most_wanted(accept, offered)) is not None:
        return found
    raise Refused(406, "not-acceptable", f"answers are {', '.join(offered)}")


def choose_form(wanted: str) -> str:
    """One of FORMS. Raises Refused 422."""
    if wanted not in FORMS:
        there = f"; there are {', '.join(FORMS)}{meant(wanted, FORMS)}"
        raise unprocessable("form", f"unknown form '{wanted[:40]}'{there}", "/query/form")
    return wanted


def most_wanted(accept: str, offered: Sequence[str]) -> str | None:
    """The most wanted of the media types offered; of equals what the header names first, then what is offered first.

    The quality of each is that of the most specific range that it is in (RFC 9110, section 12.5.1); None where all
    are refused.
    """
    ranges = _ranges(accept or "*/*")
    wanted = []
    for media in offered:
        around = (media, media.partition("/")[0] + "/*", "*/*")
        quality, place = next((ranges[each] for each in around if each in ranges), (0.0, 0))
        if quality > 0:
            wanted.append((-quality, place, media))
    return min(wanted, key=lambda each: each[:2])[2] if wanted else None


def is_refused(accept: str, what: str) -> bool:
    """Whether a header of this form, as Accept-Encoding, names something with the quality 0."""
    return _ranges(accept).get(what, (1.0, 0))[0] <= 0


def _ranges(accept: str) -> dict[str, tuple[float, int]]:
    """For every range of an Accept header its quality and its place."""
    ranges: dict[str, tuple[float, int]] = {}
    for place, item in enumerate(accept.split(",")):
        pattern, *parameters = (field.strip().lower() for field in item.split(";"))
        quality = next((p[2:] for p in parameters if p.startswith("q=")), "1")
        with suppress(ValueError):
            ranges.setdefault(pattern, (float(quality), place))
    return ranges
