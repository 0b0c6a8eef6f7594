"""The command `sevenbar forces`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

import sevenbar as sb
from sevenbar.arrays import whole_number
from sevenbar.commands import options
from sevenbar.commands.deliver import check_out, deliver
from sevenbar.commands.given import agreed, check_law, law_of, look_of
from sevenbar.commands.poses import forces_at, refuse_at
from sevenbar.errors import RequestError, no_joint, shown
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import chosen_circuit
from sevenbar.kinematics.loop.single import check_single
from sevenbar.text.units import split_quantity


def forces(
    linkage: options.Source,
    circuit: Annotated[
        int | None,
        typer.Option(help="The circuit whose forces are reported, from 0, the default; with --at all."),
    ] = None,
    at: Annotated[
        str | None,
        typer.Option(
            help="Value of the input, as in '45deg' or '12mm': torque and reactions in this pose alone, on "
            "each circuit that has it."
        ),
    ] = None,
    branch: Annotated[
        int | None,
        typer.Option(help="The pass of a circuit that rocks; of a law's 0 by default."),
    ] = None,
    samples: options.Samples = 360,
    input_joint: options.InputJoint = None,
    speed: Annotated[
        str | None,
        typer.Option(
            help="Speed of the input, as in '10 rad/s' or '60 rpm'; the file's by default; 0 for statics: at "
            "rest on every row."
        ),
    ] = None,
    law: options.Law = None,
    law_joint: options.LawJoint = None,
    law_circuit: options.LawCircuit = None,
    unevenness: Annotated[
        float | None,
        options.number_option(
            "--unevenness", "0.01", "(highest - lowest) / mean speed that a flywheel shall keep, as in 0.01."
        ),
    ] = None,
    counterweights: Annotated[
        list[str] | None,
        typer.Option(
            metavar="LINKS",
            help="Links, as in 1,3, for which counterweights are found, by least squares of the shaking.",
        ),
    ] = None,
    radius: Annotated[
        float | None,
        options.number_option(
            "--radius",
            "100",
            "How far counterweights are from their joints, in the length unit, for their masses.",
        ),
    ] = None,
    joint: Annotated[
        list[str] | None,
        typer.Option(help="A joint whose reactions are drawn; may be repeated; all of them."),
    ] = None,
    agree: options.Agree = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder for forces.csv, with every row, forces.json and the figures.")
    ] = None,
    figures: options.Figures = None,
    size: options.FigureSize = None,
    style: options.FigureStyle = None,
    force: options.Force = False,
    json: options.Json = False,
) -> None:
    """Torque of the input and what every joint bears, from bodies, loads and springs of the file."""
    from sevenbar.reporting.force_words import NOTHING_ACTS
    from sevenbar.reporting.forces import CircuitForces, forces_report
    from sevenbar.reporting.pose_forces import pose_forces_report

    look = look_of(None, size, style)
    formats = options.figure_formats(figures, out)
    if out is None:
        options.refuse_unused({"--joint": joint, "--size": size, "--style": style}, "--out")
    check_law(law, speed)
    # a motion has no speed of 0, statics do: any other does then, but its unit must be one
    quantity = None if speed is None else split_quantity(speed)
    unit = quantity[1] if quantity is not None and float(quantity[0]) == 0 else None
    at_rest = unit is not None
    rate = f"1 {unit}" if unit else None if at_rest else speed
    loaded = sb.load(linkage)
    check_single(loaded)
    if loaded.loading.is_empty:
        raise RequestError(f"{linkage}: {NOTHING_ACTS.format(place='it')}")
    names, known = options.words(joint, "--joint"), [one.name for one in loaded.joints]
    for name in names:
        if name not in known:
            raise RequestError(f"--joint: {no_joint(name, known)}")
    if at_rest and unevenness is not None:
        raise RequestError("--unevenness: at rest nothing fluctuates; give another speed, or leave it out")
    if law is not None and unevenness is not None:
        raise RequestError(
            "--unevenness: a flywheel is found for a constant speed; give --speed in place of --law"
        )
    links = [_link(name) for name in options.words(counterweights, "--counterweights", twice=False)]
    if radius is not None and not links:
        raise RequestError("--radius: it is that of counterweights; give --counterweights, as in 1,3")
    if links and (at_rest or law is not None):
        raise RequestError(
            "--counterweights: they are found for a constant speed; leave out --law and --speed 0"
        )
    if at is not None:
        unused = {"--law": law, "--unevenness": unevenness, "--counterweights": links, "--out": out}
        refuse_at(unused)
        at_value = forces_at(loaded, at, input_joint, rate, circuit, branch, agree=agree, at_rest=at_rest)
        deliver(at_value, pose_forces_report(), json=json)
        return
    circuit = circuit or 0
    report = forces_report(formats, look, names)
    check_out(report, out, force=force)
    motion = loaded.motion(
        samples,
        input=input_joint,
        speed=rate,
        law=law_of(law, loaded, input_joint, law_joint, law_circuit),
        agree=agreed(agree),
    )
    chosen = chosen_circuit(motion, circuit)
    rows = chosen.forces(at_rest=at_rest)
    chosen_pass = _pass(chosen, branch, of_law=law is not None)
    if chosen_pass is not None:
        rows = rows.on(rows.branch == chosen_pass)
    result = CircuitForces.of(motion, chosen, rows, unevenness=unevenness)
    if links:
        result = replace(result, balance=chosen.counterweights(links, radius=radius))
    deliver(result, report, out, json=json, force=force)


def _link(text: str) -> int:
    """The number of a link."""
    if not text.isdecimal():
        raise RequestError(f"--counterweights: {shown(text)} is not a link; give their numbers, as in 1,3")
    return int(text)


def _pass(circuit: Circuit, branch: int | None, *, of_law: bool) -> int | None:
    """The chosen pass of a circuit; `None` for all rows. By default all, of a law the first."""
    count = int(circuit.branch.max(initial=0)) + 1
    if branch is None:
        return 0 if of_law and count > 1 else None
    whole_number("--branch", branch, 0, count - 1, f"a pass of circuit {circuit.index}")
    return branch if count > 1 else None
