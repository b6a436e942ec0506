"""JSON that comes as a form: Octave's ``webwrite`` sends nothing else, MATLAB's does so unless it is told otherwise.

::

    webwrite (url, "json", jsonencode (request))      json=%7B%22q%22%3A...     any Octave, any MATLAB
    webwrite (url, jsonencode (request))              {"q": ...}                MATLAB
"""

from __future__ import annotations

from urllib.parse import parse_qsl

from substructures.errors import InvalidDocument

MEDIA_TYPE = "application/x-www-form-urlencoded"
FIELD = "json"


def unpacked(body: bytes) -> bytes:
    """The JSON text of a body, which is in the field ``json`` of a form or the body itself. Raises InvalidDocument."""
    start = body[:200].lstrip()
    if not start:
        raise InvalidDocument.at("", "missing", f"the body is empty; {_HOW}")
    name, is_form, _ = start.partition(b"=")
    if not is_form or not name.replace(b"_", b"a").isalnum():  # no JSON text begins with a name and '='
        return body
    fields = parse_qsl(body.decode(errors="replace"), keep_blank_values=True)
    if [each for each, _ in fields] != [FIELD]:
        shown = ", ".join(f"'{each[:40]}'" for each, _ in fields[:5])
        raise InvalidDocument.at("", "form-fields", f"a form has the one field 'json', here it has {shown}; {_HOW}")
    return fields[0][1].encode()


_HOW = 'in Octave and MATLAB: webwrite (url, "json", jsonencode (request))'
