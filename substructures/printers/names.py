"""Names from documents, made harmless for comments and formulas."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from substructures.expr.operations import Output, Symbol
from substructures.expr.steps import RESERVED
from substructures.quantities.quantity import OUTPUTS

_SAFE = frozenset("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789 _.'-+^()[]*/,:;=<>")
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*(?:\.[A-Za-z0-9_]+)*'*", re.ASCII)
_IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,63}", re.ASCII)
_PIECE = re.compile(r"([A-Za-z]+)([0-9]*)((?:_[A-Za-z0-9]+)*)", re.ASCII)
_INDEX = re.compile(r"[a-zA-Z]{0,2}[0-9]*", re.ASCII)
_LOWER = "alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi pi rho sigma tau upsilon phi chi psi"
_UPPER = "omega Gamma Delta Theta Lambda Xi Pi Sigma Upsilon Phi Psi Omega"
#: first parts of the names of quantities that belong to coordinates, forces and momenta, and their letters
_OF_COORDINATES = {"tau": "tau", "p": "p", "momentum": "p"}
#: those of quantities that belong to axes
_OF_AXES = {"linear_momentum": "p", "angular_momentum": "L"}
#: letters of quantities in LaTeX, and how many of the first indices stand above
LETTERS = {name: array.symbol for name, array in OUTPUTS.items() if array.symbol}
RAISED = {name: array.raised for name, array in OUTPUTS.items() if array.raised}
_FONT = re.compile(r"\\math(?:rm|it)|[{}]")
GREEK = frozenset(_LOWER.split()) | frozenset(_UPPER.split())
MAX_COMMENT = 200


def comment(text: str) -> str:
    """Text for the inside of a comment of any language: one line of harmless ASCII, the rest as <U+....>.

    Nothing in it ends a comment, continues a line (backslash, trigraph), or is longer than 200 characters.
    """
    escaped = "".join(c if c in _SAFE else f"<U+{ord(c):04X}>" for c in text[:MAX_COMMENT])
    while "*/" in escaped or "/*" in escaped:
        escaped = escaped.replace("*/", "* /").replace("/*", "/ *")
    return escaped


def identifier(name: str, reserved: Iterable[str], otherwise: str) -> str:
    """The name itself when it is an ASCII identifier and not reserved."""
    return name if _IDENTIFIER.fullmatch(name) and name.lower() not in reserved else otherwise


def formula_name(name: str) -> str:
    """A name as the expression grammar reads it; names that it cannot read are quoted and escaped."""
    if _NAME.fullmatch(name) and (name not in RESERVED or name == "t"):
        return name
    return '"' + comment(name) + '"'


def prefix(names: Iterable[str]) -> str:
    """A prefix for numbered temporaries that no name has."""
    taken = {m.group(1) for n in names if (m := re.fullmatch(r"([A-Za-z]+)_?[0-9]+", n, re.ASCII))}
    return next(p for p in ("t" * n for n in range(1, len(taken) + 2)) if p not in taken)


def short_names(symbols: Sequence[Symbol]) -> list[str]:
    """Names as textbooks write them, all different: no instance where there is only one, tau_1 for tau.arm.q1.

    Where that would make two names equal they stay as they are.
    """
    names = [s.name for s in symbols]
    if len({owner for n in names if (owner := instance_of(n))}) != 1:
        return names
    short = [_short(n) for n in names]
    return short if len(set(short)) == len(short) else names


def instance_of(name: str) -> str | None:
    """The instance in a name of a tree."""
    parts = name.split(".")
    return parts[-2] if len(parts) > 1 else None


def _short(name: str) -> str:
    *owners, last = name.split(".")
    if len(owners) < 2:
        return last
    numbered = re.fullmatch(r"q([0-9]+)", last, re.ASCII)
    return "_".join([*owners[:-1], numbered.group(1) if numbered else last])


def latex_names(names: Iterable[str]) -> list[str]:
    """LaTeX of names: Greek letters, digits and prefixes as subscripts, primes as dots. All different."""
    result: dict[str, None] = {}
    for name in names:
        text = _latex_name(name)
        text = text if text not in result else typewriter(name)
        result[text if text not in result else f"{text}_{{{len(result)}}}"] = None
    return list(result)


def look(latex: str) -> str:
    """Letters and indices of what is written, upright or not: what readers tell it from others by."""
    return _FONT.sub("", latex)


def letter_of(output: str, array: Output, symbols: Iterable[str]) -> str:
    """LaTeX of a quantity: its letter, or its name where a symbol (in LaTeX) looks like one of the elements."""
    letter = LETTERS.get(output)
    if letter is None:
        return latex_names([output])[0]
    separator = "," if max(array.shape, default=0) > 9 else ""
    below = [separator.join(str(i + 1) for i in index) for index in array.index or ((),)]
    places = {look(f"{letter}_{{{text}}}" if text else letter) for text in below}
    return letter if places.isdisjoint(map(look, symbols)) else latex_names([output])[0]


def latex_of(text: str) -> str:
    """LaTeX of a name, or of an element of an array: ``Gamma[1,1,2]``, ``Gamma[a, b, c]``."""
    match = re.fullmatch(r"(\w+)\[([\w, ]+)\]", text)
    if match is None:
        return latex_names([text])[0]
    index = match.group(2).replace(" ", "").split(",")
    below = ("," if any(len(x) > 1 for x in index) else "").join(index)
    return f"{latex_names([match.group(1)])[0]}_{{{below}}}"


def _latex_name(name: str) -> str:
    primes = len(name) - len(name.rstrip("'"))
    *owners, last = name[: len(name) - primes].split(".")
    match = _PIECE.fullmatch(last)
    if match is None or primes > 4 or not all(re.fullmatch(r"[A-Za-z0-9_-]+", o, re.ASCII) for o in owners):
        return typewriter(name)
    letters, digits, rest = match.groups()
    if letters not in GREEK and (len(letters) == 2 or (len(letters) == 3 and letters[0] in "IJ")):
        # lc1 is l_{c1}, Izz4 is I_{zz4}
        letters, digits = letters[0], letters[1:] + digits
    base = _base(letters)
    if primes:
        base = rf"\{'d' * primes}ot{{{base}}}"
    if len(owners) > 1 and owners[0] in _OF_COORDINATES:
        # a force is no coordinate: tau_{arm,1}, not q_{tau,arm,1}
        quantity, *owners = owners
        base, digits = _base(_OF_COORDINATES[quantity]), digits if letters == "q" and digits else letters + digits
    elif len(owners) == 1 and owners[0] in _OF_AXES and not primes:
        base, digits, owners = _OF_AXES[owners[0]], letters + digits, []
    inner = [digits] if _INDEX.fullmatch(digits) else [_subscript(digits)]
    subscripts = [*map(_subscript, owners), *filter(None, inner), *map(_subscript, rest.split("_")[1:])]
    return f"{base}_{{{','.join(subscripts)}}}" if subscripts else base


def _base(letters: str) -> str:
    return "\\" + letters if letters in GREEK else letters if len(letters) == 1 else rf"\mathit{{{letters}}}"


def _subscript(part: str) -> str:
    if part.isdigit():
        return part
    return "\\" + part if part in GREEK else rf"\mathrm{{{part.replace('_', chr(92) + '_')}}}"


def typewriter(name: str) -> str:
    """Any text as it stands, for the mathematics of LaTeX."""
    special = {"_": r"\_", "^": r"\hat{}", "'": r"\textquotesingle "}
    return r"\mathtt{" + "".join(special.get(c, c) for c in comment(name)).replace(" ", r"\ ") + "}"
