"""What is imported when it is first used: public names of packages, and entries of tables that stand in modules."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from importlib import import_module
from typing import Any, Generic, TypeVar

Entry = TypeVar("Entry")


def names_in(package: str, where: Mapping[str, tuple[str, ...]]) -> Callable[[str], Any]:
    """The ``__getattr__`` of a package whose public names stand in these modules."""
    module_of = {name: module for module, names in where.items() for name in names}

    def found(name: str) -> Any:
        """A public name. Raises AttributeError."""
        if name not in module_of:
            raise AttributeError(f"module '{package}' has no attribute '{name}'")
        value = getattr(import_module(module_of[name]), name)
        setattr(import_module(package), name, value)
        return value

    return found


class Table(Mapping[str, Entry], Generic[Entry]):
    """Entries by name in the order of ``module_of``, which says for each the module whose table ``called`` has it."""

    def __init__(self, called: str, module_of: Mapping[str, str]) -> None:
        self._called, self._module_of = called, module_of

    def __getitem__(self, name: str) -> Entry:
        """The entry; its module is imported. Raises KeyError."""
        found: Entry = getattr(import_module(self._module_of[name]), self._called)[name]
        return found

    def __iter__(self) -> Iterator[str]:
        return iter(self._module_of)

    def __len__(self) -> int:
        return len(self._module_of)

    def __contains__(self, name: object) -> bool:
        return name in self._module_of
