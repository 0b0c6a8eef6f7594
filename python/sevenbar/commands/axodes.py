"""The command `sevenbar axodes`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from sevenbar.arrays import whole_number
from sevenbar.commands import options
from sevenbar.commands.deliver import check_out, deliver
from sevenbar.commands.given import opened
from sevenbar.errors import RequestError


def axodes(
    linkage: options.Source,
    link: Annotated[
        list[int] | None, typer.Option(help="A link, counted from 1; may be repeated; all moving ones.")
    ] = None,
    relative_to: Annotated[
        int | None, typer.Option(help="The link against which they move; the ground by default.")
    ] = None,
    samples: options.Samples = 360,
    input_joint: options.InputJoint = None,
    output: options.OutputJoint = None,
    speed: options.Speed = None,
    agree: options.Agree = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder for axodes.csv, with every row, and axodes.json.")
    ] = None,
    force: options.Force = False,
    json: options.Json = False,
) -> None:
    """Screw axes of links on every row: axodes, in a plane centrodes and instant centres."""
    from sevenbar.reporting.screws import axodes_report

    loaded = opened(linkage, agree)
    ground = loaded.graph.ground
    against = ground if relative_to is None else relative_to
    links = list(dict.fromkeys(link or [n for n in loaded.graph.moving if n != against]))
    for name, value in (*(("link", n) for n in links), ("relative-to", against)):
        whole_number(f"--{name}", value, 1, ground, "a link", ", the last is the ground")
    if against in links:
        raise RequestError(f"--relative-to: link {against} is one of --link; give another")
    report = axodes_report(links, relative_to)
    check_out(report, out, force=force)
    motion = loaded.motion(samples, input=input_joint, output=output, speed=speed)
    deliver(motion, report, out, json=json, force=force)
