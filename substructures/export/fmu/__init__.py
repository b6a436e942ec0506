"""Functional Mock-up Units: a tree for Simulink, Modelica tools and other simulators, as model and with a solver.

An FMU has its description, C sources (functions of :mod:`substructures.export.languages.c`, and a simulation that is
written once, in ``runtime/``), and libraries of the platforms for which there is a compiler. States are coordinates and
velocities, with velocity constraints those of independent coordinates (q' = T v beside), with ball joints quaternions,
places and rates; inputs those of the tree, parameters tunable, outputs the other quantities of the export.
"""

from __future__ import annotations

import hashlib
from importlib.resources import files
from uuid import UUID

from substructures.export.archive import archive
from substructures.export.c_files import c_core
from substructures.export.contacts import require_few
from substructures.export.exported import Exported, Function
from substructures.export.fmu import model
from substructures.export.fmu.binaries import libraries
from substructures.export.fmu.description import build_description, description2, description3, terminals
from substructures.export.fmu.tangents import OF_ALL, OF_STATE, tangent
from substructures.export.fmu.variables import Layout, layout_of

_SHARED = ("simulation.h", "simulation.c", "fmi.h")
_OF_CONTACTS = ("contacts.h", "contacts.c", "complementarity.h", "complementarity.c")


def _differentiated(layout: Layout) -> tuple[list[Function], tuple[tuple[str, ...], tuple[str, ...]]]:
    """The functions of the motion, without the power, and what they are differentiated by."""
    motion = layout.motion
    if layout.is_tree:
        return [*([layout.changes] if layout.changes else []), motion], (OF_STATE, ())
    kept = motion.program.select(["rates", "acceleration", "second"])
    return [Function(motion.quantity, kept, motion.interface)], (("t", "q", "u", "p"), layout.velocities.names)


def fmu(exported: Exported, version: str, limit: int) -> bytes:
    """The file of version ``3.0`` or ``2.0``, for model exchange and co-simulation.

    Raises InvalidArgument where there is nothing to be simulated, MissingValue, TooLarge.
    """
    layout = layout_of(exported)
    motion, by = _differentiated(layout)
    tangents = (
        tangent("dynamics_tangent", motion, layout.interface, *by),
        tangent("outputs_tangent", layout.outputs, layout.interface, OF_ALL),
    )
    require_few(exported.contacts)
    core = Exported(f"{exported.name}_core", exported.interface, (*exported.functions, *tangents), exported.form)
    sources = c_core(core, limit)
    runtime = files(__package__) / "runtime"
    for name in (*_SHARED, *(_OF_CONTACTS if exported.contacts else ()), f"fmi{version[0]}.c"):
        sources[name] = (runtime / name).read_bytes()
    sources["model.c"] = model.source(layout, core, tangents).encode()
    told = hashlib.sha256(b"".join(sources[name] for name in sorted(sources)) + repr(layout.variables).encode())
    token = f"{{{UUID(bytes=told.digest()[:16])}}}"
    sources["model.h"] = model.header(layout, token).encode()
    units = sorted(name for name in sources if name.endswith(".c"))
    found = {f"sources/{name}": content for name, content in sources.items()}
    if version == "3.0":
        found["modelDescription.xml"] = description3(layout, token)
        found["sources/buildDescription.xml"] = build_description(layout, units)
    else:
        found["modelDescription.xml"] = description2(layout, token, units)
    frames = terminals(layout, version)
    if frames is not None and version == "3.0":
        found["terminalsAndIcons/terminalsAndIcons.xml"] = frames
    return archive(found | libraries(sources, exported.name, version))
