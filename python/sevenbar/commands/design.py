"""The commands `sevenbar design ..`: linkages for a wanted motion, and points of their links."""

from __future__ import annotations

import typer

from sevenbar.commands.command import Command
from sevenbar.commands.exact import exact
from sevenbar.commands.function import function, swing
from sevenbar.commands.path import path
from sevenbar.commands.points import inertia, point
from sevenbar.commands.survey import survey
from sevenbar.commands.task import TaskGroup, task

design = typer.Typer(
    name="design",
    cls=TaskGroup,
    add_completion=False,
    no_args_is_help=True,
    help="Find linkages for a wanted motion, and points of links; each is a file that opens in the studio.",
)

for _command in (task, function, swing, exact, survey, path, point, inertia):
    design.command(cls=Command)(_command)
