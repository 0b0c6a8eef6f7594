"""The command `sevenbar axodes`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from sevenbar.arrays import whole_number
from sevenbar.commands.deliver import check_out, deliver
from sevenbar.commands.given import opened
from sevenbar.commands.options import Agree, Force, InputJoint, Json, OutputJoint, Samples, Source, Speed
from sevenbar.errors import RequestError


def axodes(
    linkage: Source,
    link: Annotated[
        list[int] | None, typer.Option(help="A link, counted from 1; may be repeated; all moving ones.")
    ] = None,
    relative_to: Annotated[
        int | None, typer.Option(help="The link against which they move; the ground by default.")
    ] = None,
    samples: Samples = 360,
    input_joint: InputJoint = None,
    output: OutputJoint = None,
    speed: Speed = None,
    agree: Agree = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder for axodes.csv, with every row, and axodes.json.")
    ] = None,
    force: Force = False,
    json: Json = False,
) -> None:
    """Screw axes of links on every row: axodes, in a plane centrodes and instant centres."""
    from sevenbar.reporting.screws import axodes_report

    loaded = opened(linkage, agree)
    count = len(loaded.joints)
    against = count if relative_to is None else relative_to
    links = list(dict.fromkeys(link or [n for n in range(1, count + 1) if n not in (against, count)]))
    for name, value in (*(("link", n) for n in links), ("relative-to", against)):
        whole_number(f"--{name}", value, 1, count, "a link", ", the last is the ground")
    if against in links:
        raise RequestError(f"--relative-to: link {against} is one of --link; give another")
    report = axodes_report(links, relative_to)
    check_out(report, out, force=force)
    motion = loaded.motion(samples, input=input_joint, output=output, speed=speed)
    deliver(motion, report, out, json=json, force=force)
