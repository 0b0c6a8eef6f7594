"""The program `sevenbar`: it heeds Ctrl+C before anything large is imported."""

from __future__ import annotations

import os

from sevenbar.commands.signals import heed_signals, leave

# as typing has it, which is large itself
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import NoReturn


def main() -> NoReturn:
    """Runs the command line; see `sevenbar.commands.cli`."""
    heed_signals()
    # commands have no use for plugins of pydantic, and to look for them takes longer than to read a file
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    from sevenbar.commands import cli

    try:
        cli.main()
    except SystemExit as end:
        leave(end.code)
        raise


if __name__ == "__main__":
    main()
