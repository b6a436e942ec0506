"""Whom a request is for, decided once and strictly (RFC 9112, section 3.2): its one Host header, and its address; and
what counts as one address of those that requests come from.

What is decided here is passed on as data: nobody makes an address of a header again.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import lru_cache
from ipaddress import IPv6Address, ip_address

from service.messages.refusals import Refused

#: host and port; names as of DNS, addresses of IPv6 in brackets
_HOST = re.compile(r"(?:\[([0-9A-Fa-f:.]{2,45})\]|([A-Za-z0-9._-]{1,253}))(?::([0-9]{1,5}))?")
_ABSOLUTE = re.compile(rb"(?i:https?)://([^/?#]*)")
PORTS = 2**16


def host_of(headers: Iterable[tuple[bytes, bytes]]) -> str:
    """The host that a request names, in small letters, without port and brackets. Raises Refused 400."""
    given = [value for name, value in headers if name == b"host"]
    if len(given) != 1:
        raise _refused(f"a request has one Host header, not {len(given)}")
    found = _name(given[0])
    if found is None:
        raise _refused(f"the Host header is no host with an optional port: '{given[0][:80].decode('latin-1')}'")
    return found


@lru_cache(maxsize=256)
def _name(value: bytes) -> str | None:
    match = _HOST.fullmatch(value.decode("latin-1"))
    if match is None or int(match[3] or 0) >= PORTS:
        return None
    try:
        return str(IPv6Address(match[1])) if match[1] else match[2].lower()
    except ValueError:
        return None


def origin_form(url: bytes, method: bytes, headers: Iterable[tuple[bytes, bytes]]) -> bytes:
    """The target of a request from its path on. Raises Refused 400 where it is none, or names another host than the
    request itself does."""
    if url.startswith(b"/") or (url == b"*" and method == b"OPTIONS"):
        return url
    match = _ABSOLUTE.match(url)
    if match is None:
        raise _refused("the address begins with '/'")
    if [match[1].lower()] != [value.lower() for name, value in headers if name == b"host"]:
        raise _refused("the address names another host than the Host header")
    rest = url[match.end() :]
    return rest if rest.startswith(b"/") else b"/" + rest


def _refused(detail: str) -> Refused:
    return Refused(400, "invalid-host", detail)


def network_of(host: str) -> str:
    """What counts as one address: that of IPv4, the first 64 bits of IPv6."""
    try:
        address = ip_address(host.partition("%")[0])
    except ValueError:  # a socket of this machine
        return host
    if isinstance(address, IPv6Address):
        return str(address.ipv4_mapped or IPv6Address(int(address) >> 64 << 64))
    return str(address)
