"""The program `sevenbar`: it heeds Ctrl+C before anything large is imported."""

from __future__ import annotations

from sevenbar.commands.signals import heed_signals, leave

# as typing has it, which is large itself
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import NoReturn


def main() -> NoReturn:
    """Runs the command line; see `sevenbar.commands.cli`."""
    heed_signals()
    from sevenbar.commands import cli

    try:
        cli.main()
    except SystemExit as end:
        leave(end.code)
        raise


if __name__ == "__main__":
    main()
