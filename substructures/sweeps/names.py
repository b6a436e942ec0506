"""Names in a sweep that no combination of its parts has: told before anything is computed."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence

from substructures.documents import pointer_step
from substructures.documents.units import read_unit
from substructures.ensembles.quantity_columns import QuantityColumn
from substructures.errors import Fault, InvalidDocument, among
from substructures.part.definition import Definition
from substructures.part.topology import topology
from substructures.quantities.quantity import COORDINATES, array_of
from substructures.sweeps.document import WORLD, AnalysisColumn, EquilibriumColumn, ReachColumn
from substructures.sweeps.plan import Plan

#: the column of a table that has the numbers of rows
ROW = "row"


def check_names(plan: Plan, definitions: Sequence[Sequence[Definition]]) -> None:
    """Raise InvalidDocument for columns that cannot be read, and for samples, coordinates and frames that no
    combination has; ``definitions``: of the options of each instance.
    """
    columns, own = plan.columns, dict(zip(plan.instances, definitions, strict=True))
    units = {f"{n}.{p}": x.unit for n, some in own.items() for each in some for p, x in each.parameters.items()}
    units |= plan.own_units
    coordinates = {f"{n}.{q}" for n, some in own.items() for each in some for q in topology(each).coordinates}
    frames = {f"{n}.{x}" for n, some in own.items() for each in some for x in _frames(each)} | {WORLD}
    faults = [*_of_tables(plan), *_of_samples(plan, units), *_of_columns(columns.quantities, coordinates)]
    if faults := [*faults, *_of_analyses(columns.analyses, coordinates, frames)]:
        raise InvalidDocument(faults)


def _of_tables(plan: Plan) -> Iterator[Fault]:
    """Columns and samples that are called as other columns of the table are."""
    taken = {ROW, *(name for name, each in zip(plan.instances, plan.options, strict=True) if len(each) > 1)}
    for place, names in (("/columns", plan.document.columns), ("/samples/of", plan.sampler.names)):
        for name in names:
            if name in taken:
                yield Fault(f"{place}/{name}", "duplicate-name", f"the table has another column '{name}'")


def _of_samples(plan: Plan, units: Mapping[str, str]) -> Iterator[Fault]:
    """Unknown parameters, and units that are none of theirs."""
    for name, of in plan.document.samples.of.items() if plan.document.samples else ():
        pointer, unit = f"/samples/of{pointer_step(name)}", units.get(name, "")
        if name not in units:
            yield Fault(pointer, "unknown-parameter", f"unknown parameter '{name[:80]}'{among(name, units)}")
        elif of.unit and (not unit or read_unit(of.unit).dimension != read_unit(unit).dimension):
            message = f"'{of.unit}' is no unit of '{name}', which is in '{unit or '1'}'"
            yield Fault(f"{pointer}/unit", "unit-mismatch", message)


def _of_columns(quantities: Mapping[str, QuantityColumn], coordinates: Collection[str]) -> Iterator[Fault]:
    """Unknown coordinates of quantities along coordinates alone."""
    for name, column in quantities.items():
        array = array_of(column.quantity)
        if array is None or set(array.axes) != {COORDINATES} or column.of is None:
            continue
        for one in [column.of] if isinstance(column.of, str) else column.of:
            if one not in coordinates:
                message = f"unknown coordinate '{one[:80]}'{among(one, coordinates)}"
                yield Fault(f"/columns/{name}/of", "unknown-coordinate", message)


def _of_analyses(
    columns: Mapping[str, AnalysisColumn], coordinates: Collection[str], frames: Collection[str]
) -> Iterator[Fault]:
    """Unknown coordinates of equilibria, unknown frames."""
    for name, column in columns.items():
        if isinstance(column, EquilibriumColumn) and column.of not in coordinates:
            message = f"unknown coordinate '{column.of[:80]}'{among(column.of, coordinates)}"
            yield Fault(f"/columns/{name}/of", "unknown-coordinate", message)
        if isinstance(column, ReachColumn):
            for field in ("of", "about"):
                if (frame := getattr(column, field)) not in frames:
                    message = f"there is no frame '{frame[:80]}'{among(frame, frames)}"
                    yield Fault(f"/columns/{name}/{field}", "unknown-name", message)


def _frames(definition: Definition) -> list[str]:
    return ["base", *(body.name for body in definition.bodies), *(port.name for port in definition.ports)]
