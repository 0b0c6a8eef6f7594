"""The command `sevenbar tolerance`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from sevenbar.commands import options
from sevenbar.commands.deliver import check_out, deliver
from sevenbar.commands.given import opened
from sevenbar.commands.progress import progress_bar
from sevenbar.errors import RequestError, shown
from sevenbar.text.amounts import amount_in


def tolerance(
    linkage: options.Source,
    given: Annotated[
        list[str] | None,
        typer.Option(
            "--tolerance",
            metavar="NAME=VALUE",
            help="Half width of a dimension or pattern: L1=0.5, 'twist_*=0.1deg', '*=ISO 2768-m'; repeat it.",
        ),
    ] = None,
    wanted: Annotated[
        str | None,
        typer.Option(
            help="In place of --tolerance: the error allowed of the output, as in 0.5deg; finds tolerances."
        ),
    ] = None,
    circuit: Annotated[int, typer.Option(help="The circuit.")] = 0,
    samples: Annotated[int, typer.Option(help="Inputs in a full turn.")] = 90,
    count: Annotated[int, typer.Option(help="Designs drawn at random; 0 for none.")] = 2000,
    seed: Annotated[int, typer.Option(help="Seed of the random designs.")] = 0,
    distribution: Annotated[
        str, typer.Option(help="How errors spread: normal, uniform or triangular.")
    ] = "normal",
    of: Annotated[
        str | None,
        typer.Option(
            "--of",
            help="The joint or point's coordinate that deviates, as in P.x; the output by default.",
        ),
    ] = None,
    quantity: Annotated[
        str, typer.Option(help="What of it: position, velocity or acceleration.")
    ] = "position",
    input_joint: options.InputJoint = None,
    output: options.OutputJoint = None,
    speed: options.Speed = None,
    follow: options.Follow = None,
    agree: options.Agree = None,
    out: Annotated[
        Path | None,
        typer.Option(help="Folder for tolerance.json, dimensions.csv, deviation.csv and the figures."),
    ] = None,
    figures: options.Figures = None,
    force: options.Force = False,
    json: options.Json = False,
) -> None:
    """What tolerances of the dimensions do to the motion: which matters most, worst case, Monte Carlo."""
    formats = options.figure_formats(figures, out)
    if given and wanted is not None:
        raise RequestError("--wanted: --tolerance is given too; give one of them")
    loaded = opened(linkage, agree)
    from sevenbar.design.tolerance.inverse import tolerances_for
    from sevenbar.design.tolerance.linear import linear_estimate
    from sevenbar.design.tolerance.report import Findings, tolerance_report
    from sevenbar.design.tolerance.samples import monte_carlo
    from sevenbar.design.tolerance.sensitivities import sensitivities
    from sevenbar.design.tolerance.tolerances import parsed_tolerances
    from sevenbar.design.tolerance.worst import worst_case

    tolerances = parsed_tolerances(given or [])
    report = tolerance_report(formats)
    check_out(report, out, force=force)
    result = sensitivities(
        loaded,
        circuit=circuit,
        samples=samples,
        input=input_joint,
        output=output,
        speed=speed,
        follow=options.words(follow, "--follow"),
        lengths=tuple(tolerances),
    )
    if wanted is not None:
        error = _wanted(wanted, result.outputs[result.place(of, quantity)].unit)
        linear = tolerances_for(result, error, distribution=distribution, output=of, quantity=quantity)
    else:
        linear = linear_estimate(result, tolerances, distribution=distribution, output=of, quantity=quantity)
    with progress_bar(f"designs within the tolerances of {loaded.heading}") as progress:
        # one bar for both
        worst = worst_case(result, linear, progress=lambda done, total, _="": progress(done, total + count))
        tried, exact = worst.tried, None
        if count != 0:
            exact = monte_carlo(
                result,
                linear,
                count,
                seed=seed,
                progress=lambda done, total, _="": progress(tried + done, tried + total),
            )
    deliver(Findings(linear, worst, exact), report, out, json=json, force=force)


def _wanted(text: str, unit: str) -> float:
    """An error [the output's unit] as a person wrote it; an angle alone is in degrees."""
    plain = "deg" if unit == "rad" else unit
    value = amount_in(text, unit, plain)
    if value is None or value <= 0:
        raise RequestError(
            f"--wanted: {shown(text)} is not an error; give one greater than 0, as in "
            f"0.5{' ' * ('/' in plain)}{plain}"
        )
    return value
