"""The command `sevenbar axodes`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from sevenbar.commands import options
from sevenbar.commands.deliver import check_out, deliver
from sevenbar.commands.given import link_of, opened
from sevenbar.errors import RequestError


def axodes(
    linkage: options.Source,
    link: Annotated[
        list[str] | None,
        typer.Option(help="A link, counted from 1; of a net, or its name; may be repeated; all moving ones."),
    ] = None,
    relative_to: Annotated[
        str | None, typer.Option(help="The link against which they move; the ground by default.")
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
    base = None if relative_to is None else link_of("--relative-to", relative_to, loaded)
    against = loaded.graph.ground if base is None else base
    asked = [link_of("--link", one, loaded) for one in link or ()]
    links = list(dict.fromkeys(asked or [n for n in loaded.graph.moving if n != against]))
    if against in links:
        raise RequestError(f"--relative-to: {loaded.link_name(against)} is one of --link; give another")
    report = axodes_report(links, base)
    check_out(report, out, force=force)
    motion = loaded.motion(samples, input=input_joint, output=output, speed=speed)
    deliver(motion, report, out, json=json, force=force)
