"""Robot files in installed packages that nobody here wrote; nothing of these packages is imported."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path


def urdf_files() -> dict[str, Path]:
    """Of the package example-robot-data, by their path in it."""
    return dict(_files("example-robot-data", "urdf"))


def mjcf_files() -> dict[str, Path]:
    """Of the packages dm_control and brax, by their path in them: what has <mujoco> as its root and a body."""
    found = {**dict(_files("dm_control", "xml")), **dict(_files("brax", "xml"))}
    return {name: path for name, path in found.items() if _is_whole(path)}


def more_files() -> dict[str, Path]:
    """URDF and MJCF files of the packages airo-models, robosuite and pybullet (of its random objects a few)."""
    found: dict[str, Path] = {}
    for package in ("airo-models", "pybullet", "robosuite"):
        found |= dict(_files(package, "urdf"))
        found |= {name: path for name, path in _files(package, "xml") if _is_whole(path)}
    return {name: path for name, path in found.items() if "random_urdfs" not in name or int(path.stem) % 100 == 0}


def _is_whole(path: Path) -> bool:
    text = path.read_text(errors="replace")
    return "<mujoco" in text and "<body" in text


class Beside(dict[str, bytes]):
    """The files that lie about a file, read when they are asked for."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self._folder = path.parent

    def __contains__(self, name: object) -> bool:
        return (self._folder / str(name)).is_file()

    def __getitem__(self, name: str) -> bytes:
        return (self._folder / name).read_bytes()


def included(path: Path) -> dict[str, bytes]:
    """The contents of the files that a file includes or takes meshes from, by their names in it."""
    return Beside(path)


def _files(package: str, ending: str) -> Iterator[tuple[str, Path]]:
    try:
        found = files(package) or []
    except PackageNotFoundError:
        return
    for file in sorted(found, key=str):
        if file.suffix == f".{ending}":
            yield "/".join(Path(str(file)).parts[-3:]), Path(str(file.locate()))
