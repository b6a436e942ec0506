"""What a certificate says of how formulas agree with the documents, and what one that is made anew has to say."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from decimal import Decimal
from typing import Any

from substructures.certificate.compare import TOLERANCE, Compared
from substructures.errors import VerificationFailed, listed

#: how formulas are compared, in every certificate; those of older versions say less
HOW = {"compared_with": "documents", "tolerance": TOLERANCE}


def told(found: Compared) -> dict[str, Any]:
    """What a comparison says in a certificate: ``potential_left_out`` where there is anything to say."""
    left_out = {"potential_left_out": found.left_out} if found.left_out else {}
    return {"max_relative_error": found.errors, **left_out}


def not_judged(certificate: Mapping[str, Any]) -> list[str]:
    """The outputs of which a certificate cannot tell whether they are right."""
    errors: Mapping[str, Any] = certificate.get("direct_form", {}).get("max_relative_error", {})
    return [name for name, error in errors.items() if error is None]


def not_judged_warnings(quantities: Iterable[str]) -> list[dict[str, str]]:
    """A warning for each of these quantities, whose programs have outputs that are not judged."""
    return [
        {
            "pointer": "",
            "code": "not-judged",
            "message": f"'{name[:80]}' could not be judged: some of what it has to be by the documents has no finite "
            "value at any state that was tried",
        }
        for name in dict.fromkeys(quantities)
    ]


def require_no_less(before: Mapping[str, Any], now: Mapping[str, Any]) -> None:
    """Raise VerificationFailed where a certificate made anew vouches for less than the one that is stored."""
    given = {name: before.get(name) for name in HOW}
    # what was compared otherwise vouches for nothing that could be lost; numbers of documents are decimals
    if {name: float(x) if isinstance(x, Decimal) else x for name, x in given.items()} != HOW:
        return
    was, found = before.get("direct_form", {}), now["direct_form"]
    errors = was.get("max_relative_error", {})
    lost = [n for n, error in found["max_relative_error"].items() if error is None and errors.get(n) is not None]
    if lost:
        raise VerificationFailed(f"{listed(lost)} had values that could be compared with the documents, and has none")
    left_out = set(found.get("potential_left_out", ())) - set(was.get("potential_left_out", ()))
    if left_out:
        raise VerificationFailed(f"the potential of the forces on {listed(sorted(left_out))} is left out")


def told_figures(operations: Mapping[str, int], certificate: Mapping[str, Any]) -> str:
    """How much metric and Christoffel symbols take, and the largest error of a certificate, in words."""
    counts = (f"{name} {operations.get(name, 'not stored')}" for name in ("metric", "christoffel"))
    errors = certificate.get("direct_form", {}).get("max_relative_error", {})
    known = [error for error in errors.values() if error is not None]
    agrees = f"agrees with the direct form to {max(known):.0e}" if known else "not verified"
    return f"operations: {', '.join(counts)}; {agrees}"
