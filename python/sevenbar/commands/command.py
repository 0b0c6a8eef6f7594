"""What every command has: `-o` for `--out`, and an option that is given once only; and numbers."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping
from functools import cache
from typing import Annotated, Any

import typer.core
import typer.main

from sevenbar.drawing.asked import drawn_as
from sevenbar.errors import RequestError, SevenbarError, shown
from sevenbar.text.words import check_language, language

#: What to say of options of which a second one is a mistake in thought, too.
WHY_ONE = {
    "--input": "one joint drives, so give one of them (loops with two inputs are not covered)",
    "--output": "one joint is the output, so give one of them",
}


#: Calls that show what a command does, below its options.
EXAMPLES = {
    "forces": (
        "sevenbar forces rssr_press",
        "sevenbar forces press.toml --speed '90 rpm' --unevenness 0.02 -o forces",
        "sevenbar forces engine --at 45deg",
        "sevenbar forces engine --speed 0 --json",
    ),
    "analyze": (
        "sevenbar analyze rssr",
        "sevenbar analyze mine.toml --speed '60 rpm' -o report",
        "sevenbar analyze rssr --input rocker --json",
    ),
    "modes": (
        "sevenbar modes seven_r --at 30deg",
        "sevenbar modes rssp --input slider --at=-20mm",
        "sevenbar modes bennett --at 0.5rad -o modes.svg",
    ),
    "plot": (
        "sevenbar plot seven_r -o figures",
        "sevenbar plot rssr --kind curves,point --link 2 --at 500,40,0 --figures svg -o figures",
    ),
    "axes": ("sevenbar axes machine.step -o axes.csv",),
    "axodes": (
        "sevenbar axodes rssr --link 2",
        "sevenbar axodes planar_4r --link 2 --relative-to 1 -o axodes",
    ),
    "free": (
        "sevenbar free drop.toml --time 10s --from 30deg",
        "sevenbar free drop.toml --speed '60 rpm' --film drop.html -o free",
    ),
    "gallery": ("sevenbar gallery", "sevenbar gallery rssr > mine.toml"),
    "studio": ("sevenbar studio seven_r", "sevenbar studio mine.toml --port 9000 --no-open"),
    "simulate": (
        "sevenbar simulate rssr",
        "sevenbar simulate seven_r --engine mujoco --circuit 2 -o check",
    ),
    "export": (
        "sevenbar export rssr --to step",
        "sevenbar export rssr --to adams --at 30deg",
        "sevenbar export seven_r --circuit 2 --at 0.5rad -o mode_2.glb",
        "sevenbar export rssr -o motion.parquet --units si",
    ),
    "compare": ("sevenbar compare rssr examples/rssr_table1.csv",),
    "calibrate": ("sevenbar calibrate rssr examples/rssr_bench.csv --hold D --offset input,output -o bench",),
    "sweep": (
        "sevenbar sweep rssr --over L1=100:400:31 --over L3=300:800:51 --measure motion_type,swing -o sweep",
    ),
    "map": ("sevenbar map rssr --over L1=100:400 --over L3=300:800 --measure transmission_lowest -o maps",),
    "tolerance": ("sevenbar tolerance rssr --tolerance 'L*=0.5mm' --tolerance M=1 -o tolerance",),
    "survey": (
        "sevenbar design survey --output-range 0:23.75deg --ball-angle 15deg --count 1e6 -o flap",
        "sevenbar design survey --swing 60deg --time-ratio 1.1 --bound angle=60:120deg --rank transmission",
        "sevenbar design survey my_task.toml --count 1e4 --journal kept",
    ),
    "swing": ("sevenbar design swing --swing 60deg --time-ratio 1.2 -o swing",),
    "path": (
        "sevenbar design path planar_4r --path examples/coupler_curve.csv --link 2 --at 0,-50,20 "
        "--vary 'length_*' --vary P.v --vary P.w -o coupler",
    ),
    "point": ("sevenbar design point seven_r --link 4 --box=-200:200,-200:200,-200:200 -o point",),
    "inertia": ("sevenbar design inertia seven_r --mass P=2.5 -o torque",),
    "task": (
        "sevenbar design task examples/design/steering_task.toml -o steering",
        "sevenbar design task examples/design/nozzle_task.toml --designs 3 --json",
    ),
    "exact": (
        "sevenbar design exact poses.csv -o dyads",
        "sevenbar design exact pairs.csv --twist 90deg --zeros 30deg,90deg --json",
    ),
    "function": ("sevenbar design function --y 'x^2' --x 0:1 -o parabola",),
}


#: What the parser of options, whose words depend on its version, says of a text that is no number, and
#: the message in its place.
NUMBERS = {
    "valid integer": "a whole number; give one, as in 2",
    "valid number": "a number; give one, as in 0.5 or 1e-5",
    "valid float": "a number; give one, as in 0.5 or 1e-5",
}

#: What two options mean, wherever a command has them.
VIEW_HELP = "plane, space, xy, xz, yz or iso, or elevation and azimuth, as in '30,-60'."
STYLE_HELP = "Style of the figures: screen, paper or ieee."

#: Commands with the options of `_shared`, besides those that have one of their own.
_DRAWING = (
    *("modes", "map", "tolerance", "task", "function", "swing", "path", "point", "inertia"),
    *("compare", "calibrate", "simulate"),
)
SHARED = {
    "--view": ("modes", "task", "path", "point"),
    "--style": _DRAWING,
    "--lang": ("analyze", "plot", "forces", "free", "sweep", "survey", *_DRAWING),
}


def _draw_from(ctx: typer.Context, view: str | None) -> None:
    if view is not None:
        from sevenbar.commands.given import view_of

        ctx.with_resource(drawn_as(view=view_of(view)))


def _draw_in_style(ctx: typer.Context, style: str | None) -> None:
    if style is not None:
        # matplotlib is needed from here on
        from sevenbar.drawing.style import check_style

        ctx.with_resource(drawn_as(style=check_style(style, "--style")))


def _say_language(ctx: typer.Context, lang: str | None) -> None:
    if lang is not None:
        ctx.with_resource(language(check_language(lang, "--lang")))


def _shared(
    view: Annotated[str | None, typer.Option(help=VIEW_HELP, callback=_draw_from, expose_value=False)] = None,
    style: Annotated[
        str | None, typer.Option(help=STYLE_HELP, callback=_draw_in_style, expose_value=False)
    ] = None,
    lang: Annotated[
        str | None,
        typer.Option(
            help="Language of the report and the figures: en (the default) or zh.",
            callback=_say_language,
            expose_value=False,
        ),
    ] = None,
) -> None:
    """Options whose meaning holds for all that is made until the command ends."""


@cache
def _shared_options() -> dict[str, Any]:
    """The options of `_shared` by their names."""
    alone = typer.Typer(add_completion=False)
    alone.command()(_shared)
    return {option: made for made in typer.main.get_command(alone).params for option in made.opts}


class Command(typer.core.TyperCommand):
    """A command of sevenbar."""

    def __init__(self, name: str | None, *args: Any, **options: Any) -> None:
        if not options.get("epilog") and name in EXAMPLES:
            # lines of a paragraph would flow into each other
            options["epilog"] = "\n\n".join(("Examples:", *EXAMPLES[name]))
        super().__init__(name, *args, **options)
        self.params += [_shared_options()[option] for option, commands in SHARED.items() if name in commands]
        for parameter in self.params:
            if "--out" in parameter.opts and "-o" not in parameter.opts:
                parameter.opts.append("-o")

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """As usual; an option given twice is refused, of which otherwise the last would count silently."""
        # the parser takes words off the list
        given, _, order = self.make_parser(ctx).parse_args(args=list(args))
        for parameter, count in Counter(order).items():
            single = parameter.param_type_name == "option" and not parameter.multiple
            if count > 1 and single and not getattr(parameter, "is_flag", False):
                option = parameter.opts[0]
                raise RequestError(f"{option}: given {count} times; {WHY_ONE.get(option, 'give it once')}")
        try:
            return super().parse_args(ctx, args)
        except Exception as error:
            if wrong := _no_number(error, given):
                raise RequestError(wrong) from None
            raise


def _no_number(error: Exception, given: Mapping[str, Any]) -> str:
    """The message for an option whose text is no number; empty for any other error of the parser."""
    parameter, words = getattr(error, "param", None), getattr(error, "message", "")
    kind = next((wanted for said, wanted in NUMBERS.items() if said in words), "")
    if parameter is None or not kind:
        return ""
    return f"{parameter.opts[0]}: {shown(given.get(parameter.name))} is not {kind}"


def count_of(option: str) -> Callable[[object], int]:
    """What reads the number of an option, whole and perhaps with an exponent: 360, 1e6.

    >>> count_of("--samples")("1e6")
    1000000
    """

    def read(given: object) -> int:
        text = str(given).strip()
        try:
            return int(text)
        except ValueError:
            pass
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not value.is_integer():
            # no RequestError: the reader of options would take a ValueError for its own
            raise SevenbarError(
                f"{option}: {shown(text)} is not a count; give a whole number, as in 360 or 1e6"
            )
        return int(value)

    return read


def number_of(option: str, example: str) -> Callable[[object], float]:
    """What reads the number of an option, or a formula: 0.01, 1e-5, 1/100.

    >>> number_of("--unevenness", "0.01")("1/50")
    0.02
    """

    def read(given: object) -> float:
        from sevenbar.text.expression import constant_of

        value = constant_of(str(given))
        if value is None:
            raise SevenbarError(f"{option}: {shown(str(given))} is not a number; give one, as in {example}")
        return value

    return read
