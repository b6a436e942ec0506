"""Which kinds of flange meet: the interface of a port, and that of the mount of what is put on it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from substructures.expr.units.unit_check import Notice
from substructures.part.definition import Definition
from substructures.tree.document import TreeSpec


def differing_interfaces(spec: TreeSpec, definitions: Mapping[str, Definition]) -> Iterator[Notice]:
    """A notice for every instance whose mount has another interface than the port of its host; by instance the
    ``definitions``. Where one of them names none, everything fits.
    """
    for i, instance in enumerate(spec.instances):
        host, _, name = instance.at.partition(".")
        mount = definitions[instance.name].mount
        ports = {port.name: port.interface for port in definitions[host].ports} if host in definitions else {}
        given = ports.get(name, "")
        if mount is not None and mount.interface and given and mount.interface != given:
            message = f"'{instance.at}' is a '{given}', and '{instance.name}' is made for a '{mount.interface}'"
            yield {"pointer": f"/instances/{i}/at", "code": "interfaces-differ", "message": message}
