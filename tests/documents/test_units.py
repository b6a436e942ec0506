"""Units of measurement: exact factors to SI, and the dimensions of expressions."""

from __future__ import annotations

import math
import subprocess
import sys
from decimal import Decimal
from fractions import Fraction

import pint
import pytest

from substructures.documents import units
from substructures.documents.units import NUMBER, UnknownUnitError, read_unit, si_text
from substructures.expr.direct import value
from substructures.expr.syntax import read
from substructures.expr.units.dimensions import Dimensioned, DimensionError, Inference, Inferred

#: exact by definition: BIPM, The International System of Units (9th ed., 2019), tables 4, 7, 8; pound and yard of 1959
EXACT = {
    ("mm", 1200): Decimal("1.2"),
    ("km", Decimal("0.25")): 250,
    ("in", 1): Decimal("0.0254"),
    ("lb", 1): Decimal("0.45359237"),
    ("t", 3): 3000,
    ("g cm^2", 5): Decimal("5e-7"),
    ("min", 2): 120,
    ("kgf", 1): Decimal("9.80665"),
    ("kNm", 3): 3000,
    ("N mm", 3): Decimal("0.003"),
    ("kg·m²", 7): 7,
    ("km/h", 36): 10,
}


@pytest.mark.parametrize(("unit", "given"), EXACT)
def test_numbers_are_converted_exactly(unit: str, given: int | Decimal) -> None:
    assert read_unit(unit).in_si(given) == EXACT[unit, given]


@pytest.mark.parametrize(
    ("unit", "given", "expected"),
    [
        ("deg", 30, "1/6*pi"),
        ("deg", 0, 0),
        ("rpm", 45, "3/2*pi"),
        ("turn", Decimal("0.5"), "1*pi"),
        ("N m/deg", 1, "180*pi^-1"),
        ("deg", "2/3", "(2/3)*1/180*pi"),
        ("km/h", 1, "5/18"),
        ("mm", "1/3", "(1/3)*1/1000"),
    ],
)
def test_what_is_no_decimal_becomes_an_exact_expression(unit: str, given: int | str, expected: int | str) -> None:
    found = read_unit(unit)
    assert found.in_si(given) == expected
    assert math.isclose(float(value(found.in_si(given))), float(value(given)) * found.scale, rel_tol=1e-15)


@pytest.mark.parametrize("text", [text for text in units._SI if "Nm" not in text])
def test_the_usual_spellings_are_what_pint_makes_of_them(text: str) -> None:
    known = read_unit(text)
    root = pint.get_application_registry().Quantity(1, text.replace("Nm", "N m")).to_base_units()
    found = {str(name): int(n) for name, n in root.unit_items() if name != "radian"}
    names = ("meter", "kilogram", "second", "ampere", "kelvin", "mole", "candela")
    assert (known.is_si, known.dimension) == (root.magnitude == 1, tuple(found.get(name, 0) for name in names))
    assert known.si == text


@pytest.mark.parametrize(
    "text",
    [
        *("", "furlogs", "10 m", "m**m", "10**10**10", "(m", "m)", "degC", "dB", "bit", "m^999", "__import__('os')"),
        *("m;s", "m" * 65, "statC", "USD", "1/0", "m\u0000", "**"),
    ],
)
def test_what_is_no_unit_is_refused(text: str) -> None:
    with pytest.raises(UnknownUnitError):
        read_unit(text)


def test_units_are_written_in_si() -> None:
    texts = {
        "mm": "m",
        "lb": "kg",
        "deg": "rad",
        "rpm": "rad/s",
        "N mm/deg": "N m/rad",
        "kgf": "N",
        "W/mm": "m kg s^-3",
    }
    assert {text: read_unit(text).si for text in texts} == texts
    assert si_text(NUMBER) == "1"
    assert read_unit("N*m").si == "N*m"


def test_pint_is_loaded_only_for_what_is_not_usual() -> None:
    program = (
        "import sys; from substructures.documents.units import read_unit; read_unit('{}'); print('pint' in sys.modules)"
    )
    found = [
        subprocess.run([sys.executable, "-c", program.format(unit)], capture_output=True, text=True, check=True).stdout
        for unit in ("N*m/rad", "mm")
    ]
    assert [line.strip() for line in found] == ["False", "True"]


LENGTH, MASS, TIME = ((1, 0, 0, 0, 0, 0, 0), (0, 1, 0, 0, 0, 0, 0), (0, 0, 1, 0, 0, 0, 0))
NAMES: dict[str, Inferred] = {
    "l": Dimensioned(LENGTH),
    "m": Dimensioned(MASS),
    "T": Dimensioned(TIME),
    "r": Dimensioned(NUMBER),
    "x": Dimensioned(LENGTH, sure=False),
}


def _inferred(text: str) -> tuple[Inferred, list[str]]:
    inference = Inference(lambda name: NAMES.get(name, "unknown"))
    return inference.of(read(text)), inference.doubts


@pytest.mark.parametrize(
    ("text", "unit", "sure"),
    [
        ("l", "m", True),
        ("-l + 0.5", "m", True),
        ("2*l", "m", False),
        ("2*l + l", "m", True),
        ("m*l^2/12", "kg m^2", False),
        ("m*l*l*sin(l/l)", "kg m^2", True),
        ("sqrt(l^2 + l*l)/T", "m/s", True),
        ("l/T^2", "m/s^2", True),
        ("x + l", "m", True),
        ("-x", "m", False),
        ("m*(1 + cos(2*r))", "kg", False),
        ("1/T", "s^-1", False),
    ],
)
def test_dimensions_follow_expressions(text: str, unit: str, sure: bool) -> None:
    found, doubts = _inferred(text)
    assert isinstance(found, Dimensioned)
    assert (found.dimension, found.sure, doubts) == (read_unit(unit).dimension, sure, [])


@pytest.mark.parametrize("text", ["3", "pi/2", "u*l", "l*u + m*u", "sin(r)", "2*r", "cos(pi/3)*2", "l^0", "u^2 + 1"])
def test_what_has_no_unit_stands_for_anything(text: str) -> None:
    found, doubts = _inferred(text)
    assert not isinstance(found, Dimensioned)
    assert not doubts


@pytest.mark.parametrize(
    "text", ["l + T", "l*m - T", "sin(l)", "cos(T/m)", "sqrt(l) + l", "l^2 + l", "r + l", "tan(l*T)*u"]
)
def test_contradictions_are_found(text: str) -> None:
    with pytest.raises(DimensionError):
        _inferred(text)


@pytest.mark.parametrize("text", ["2*l + T", "sin(3*T)", "x + T", "l + 4*l^2"])
def test_what_numbers_with_units_would_explain_is_a_doubt(text: str) -> None:
    assert len(_inferred(text)[1]) == 1


def test_a_half_dimension_is_kept_exactly() -> None:
    found, _ = _inferred("sqrt(l)")
    assert isinstance(found, Dimensioned)
    assert found.dimension[0] == Fraction(1, 2)
