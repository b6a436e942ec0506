"""Where the program ``substructures`` begins: Ctrl-C ends it quietly, also while the rest is still imported."""

from __future__ import annotations

import sys


def main() -> int:
    """The exit code of :func:`service.cli.main.main`; 130 after Ctrl-C."""
    try:
        from service.cli.main import main as run  # noqa: PLC0415 -- takes a tenth of a second, in which it is waited for

        return run()
    except KeyboardInterrupt:
        return 130


if __name__ == "__main__":
    sys.exit(main())
