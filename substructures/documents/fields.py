"""Parts of documents, and what their fields share: names, exact and finite numbers with their units, vectors."""

from __future__ import annotations

import math
import numbers
import re
from collections.abc import Mapping
from decimal import Decimal
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, ValidationInfo, WithJsonSchema
from pydantic_core import PydanticCustomError

from substructures.documents.patterns import LIBRARY_NAME, NAME, TAG
from substructures.documents.units import Unit, UnknownUnitError, read_unit

#: a number or a product or quotient of them, pi among them; how a unit begins
_CONSTANT = re.compile(r"[-+]?(?:[\d.]+(?:[eE][-+]?\d+)?|pi)(?:[*/](?:[\d.]+(?:[eE][-+]?\d+)?|pi))*")
_UNIT = re.compile(r"[^\W\d_]|[°%]|1\s*/")
_WITH_UNIT = re.compile(r"([-+]?[0-9]*\.?[0-9]+(?:[eE][-+]?[0-9]+)?)\s*([^\W\d_][^\s]*(?:\s[^\s]+)?|[°%])")
LONGEST = 10_000  # characters of an expression, as its reader has it
_EITHER = [{"type": "number"}, {"type": "string", "maxLength": LONGEST}]


#: what says nothing and hides something: controls but for tabs and ends of lines, and those that turn text round
_HIDDEN = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")


def hidden(text: str) -> str:
    """What is wrong with a text that has characters which nobody sees; empty where there is none."""
    found = _HIDDEN.search(text)
    if found is None:
        return ""
    what = f"character {found.start() + 1} is U+{ord(found[0]):04X}, a control character"
    return f"{what}; of these a text has tabs and ends of lines alone"


def shown(text: str) -> str:
    """A text without what nobody sees."""
    return _HIDDEN.sub("", text)


def _readable(text: str, info: ValidationInfo) -> str:
    """Refuse what is not meant to be read, unless it was stored when it was accepted."""
    message = "" if info.context and info.context.get("stored") else hidden(text)
    if message:
        raise PydanticCustomError("control-character", "{message}", {"message": message})
    return text


#: text for people
Words = Annotated[str, AfterValidator(_readable)]


class DocumentPart(BaseModel):
    """Base of all parts of documents: frozen, unknown fields refused."""

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)


class Quantity(DocumentPart):
    """A number with its unit, exact in SI: 1200 mm is 6/5 m. ``value``: a number or a constant expression."""

    value: Annotated[int | Decimal | str, WithJsonSchema({"anyOf": _EITHER})]
    unit: str = Field(max_length=64)

    @property
    def measure(self) -> Unit:
        """The unit, read. Raises UnknownUnitError."""
        return read_unit(self.unit)

    @property
    def si(self) -> int | Decimal | str:
        """How many SI units it is: a number, or a constant expression (``"1/6*pi"`` of 30 deg)."""
        return self.measure.in_si(self.value)

    def __str__(self) -> str:
        """As people write it."""
        return f"{self.value} {self.unit}"


def quantity_of(text: str) -> Quantity | str:
    """A text such as ``1200 mm``: a constant, a space and a unit; any other text as it is.

    >>> quantity_of("1/2 m"), quantity_of("2*l")
    (Quantity(value='1/2', unit='m'), '2*l')
    """
    value, _, unit = text.strip().partition(" ")
    unit = unit.strip()
    return Quantity(value=value, unit=unit) if _CONSTANT.fullmatch(value) and _UNIT.match(unit) else text


def unit_advice(text: str) -> str:
    """How a number with a unit is written, where an expression is none but for that; otherwise nothing.

    >>> unit_advice("500g")
    '; a number with a unit is written {"value": 500, "unit": "g"}'
    """
    found = with_unit(text)
    return f'; a number with a unit is written {{"value": {found.value}, "unit": "{found.unit}"}}' if found else ""


def with_unit(text: str) -> Quantity | None:
    """A number and a known unit behind it, also without a space between them; None of any other text."""
    match = _WITH_UNIT.fullmatch(text.strip())
    try:
        read_unit(match[2] if match else "")
    except UnknownUnitError:
        return None
    return Quantity(value=match[1], unit=match[2]) if match else None


def unit_of(text: str) -> Unit:
    """The unit of a field. Raises PydanticCustomError."""
    try:
        return read_unit(text)
    except UnknownUnitError as error:
        raise PydanticCustomError("unknown-unit", "{message}", {"message": str(error)}) from None


def _quantity(given: Mapping[Any, Any]) -> Quantity:
    if set(given) != {"value", "unit"} or not isinstance(given["unit"], str):
        raise PydanticCustomError("number-expected", "expected a number, an expression, or 'value' and 'unit'")
    unit_of(given["unit"])
    return Quantity(value=_plain_number(given["value"]), unit=given["unit"])


def in_si(value: Any) -> Any:
    """The SI value of a number of a document; what has no unit is SI."""
    return value.si if isinstance(value, Quantity) else value


def _number(value: Any) -> Any:
    """Exact number or expression text, with a unit or without."""
    if isinstance(value, Mapping):
        return _quantity(value)
    return value if isinstance(value, Quantity) else _plain_number(value)


def _plain_number(value: Any) -> Any:
    """Exact number or expression text; floats are taken by their shortest decimal text."""
    if isinstance(value, bool) or not isinstance(value, (int, float, Decimal, str, numbers.Real)):
        raise PydanticCustomError("number-expected", "expected a number or an expression")
    if isinstance(value, numbers.Rational):  # an integer of NumPy, a fraction
        value = int(value.numerator) if value.denominator == 1 else f"{value.numerator}/{value.denominator}"
    if isinstance(value, str) and len(value) > LONGEST:
        raise PydanticCustomError("bad-expression", f"an expression has at most {LONGEST} characters")
    if isinstance(value, numbers.Real) and not isinstance(value, int):
        value = Decimal(repr(float(value)))
    if isinstance(value, Decimal) and not value.is_finite():
        raise PydanticCustomError("number-not-finite", "the number is not finite")
    return value


def _real(value: Any) -> float:
    """A finite number; no text, no truth value."""
    if isinstance(value, bool) or not isinstance(value, (int, float, Decimal, numbers.Real)):
        raise PydanticCustomError("number-expected", "a number is needed")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise PydanticCustomError("number-not-finite", "the number is not finite")
    return number


def _numeric(value: Any) -> Any:
    """What may be a number; no text, no truth value, which pydantic would take for one."""
    if isinstance(value, bool | str):
        raise PydanticCustomError("number-expected", "a number is needed")
    return value


#: behind the bounds of a count or a number, ``Annotated[int, Field(ge=1), NUMERIC]``: schemas tell the bounds then
NUMERIC = BeforeValidator(_numeric)
#: a number that has no unit of its own
PlainNumber = Annotated[int | Decimal | str, BeforeValidator(_plain_number), WithJsonSchema({"anyOf": _EITHER})]
Number = Annotated[
    Annotated[int | Decimal | str, WithJsonSchema({"anyOf": _EITHER})] | Quantity, BeforeValidator(_number)
]
Real = Annotated[float, BeforeValidator(_real), WithJsonSchema({"type": "number"})]
Positive = Annotated[Real, Field(gt=0)]
NumberVector = tuple[Number, Number, Number]
Name = Annotated[str, Field(pattern=NAME)]
LibraryName = Annotated[str, Field(pattern=LIBRARY_NAME)]
TagName = Annotated[str, Field(pattern=TAG)]


def _with_type(data: Any) -> Any:
    """An object without a type has the empty one, so that it is told which types there are."""
    return {"type": "", **data} if isinstance(data, Mapping) and "type" not in data else data


#: of unions whose field 'type' says which it is
BY_TYPE = BeforeValidator(_with_type)
