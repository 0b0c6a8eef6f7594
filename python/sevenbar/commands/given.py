"""What the texts of options mean; a text that means nothing is a `RequestError`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import sevenbar as sb
from sevenbar.arrays import whole_number
from sevenbar.errors import RequestError, shown, suggestion
from sevenbar.kinematics.linkage import closure_tolerance
from sevenbar.kinematics.loop.joint_text import joint_value
from sevenbar.text.amounts import amount_in
from sevenbar.text.expression import constant_of
from sevenbar.text.ranges import Place, split_list, split_range, three_numbers, with_common_unit
from sevenbar.text.units import amount, examples_of, sizes_of

if TYPE_CHECKING:
    from sevenbar.description.draft import Draft
    from sevenbar.design.limits import Limits
    from sevenbar.kinematics.loop.law import Law
    from sevenbar.reporting.figures import FigureLook


def check_law(law: Path | None, speed: str | None) -> None:
    """Refuses a speed where there is a law."""
    if law is not None and speed is not None:
        raise RequestError("--speed: a law gives the speed; leave --speed or --law out")


def agreed(agree: float | None) -> float | None:
    """The closure error of --agree, if one is given."""
    return None if agree is None else closure_tolerance("--agree", agree)


def opened(source: str, agree: float | None) -> sb.Linkage:
    """The linkage of FILE|NAME and --agree."""
    return sb.load(source, agree=agreed(agree))


def drafted(source: str, agree: float | None) -> Draft:
    """The same to be shaped: with the text of the file."""
    from sevenbar.description.draft import Draft
    from sevenbar.description.files import toml_text

    return Draft.of(toml_text(source), source, agree=agreed(agree))


def law_of(
    law: Path | None,
    linkage: sb.Linkage,
    input_joint: str | None,
    joint: str | None = None,
    circuit: int | None = None,
) -> Law | None:
    """The law of --law, if one is given, of the --law-joint and --law-circuit of its table."""
    if law is None:
        for option, value in (("--law-joint", joint), ("--law-circuit", circuit)):
            if value is not None:
                raise RequestError(f"{option}: there is no table of a law; give --law, too")
        return None
    return sb.load_law(law, linkage, input=input_joint, joint=joint, circuit=circuit)


def input_value(option: str, text: str, linkage: sb.Linkage, input_joint: str | None) -> float:
    """A value [rad, or length] of the joint of --input."""
    return joint_value(text, option, linkage, linkage.input_column(input_joint, "--input"))


def link_of(option: str, text: str, linkage: sb.Linkage) -> int:
    """The link, counted from 1, of an option that gives its number, or its name in a net.

    >>> link_of("--link", "lever", sb.load("watt"))
    5
    """
    names = linkage.link_names
    if text in names:
        return names.index(text) + 1
    try:
        number = int(text)
    except ValueError:
        known = ", ".join(names) or f"1 to {linkage.graph.ground}, the last is the ground"
        what = f"{shown(text)} is not a link; {suggestion(text, names)}give {known}"
        raise RequestError(f"{option}: {what}") from None
    return whole_number(option, number, 1, linkage.graph.ground, "a link", ", the last is the ground")


def point_of(
    name: str | None, link: str | None, at: str | None, linkage: sb.Linkage
) -> str | tuple[int, Place] | None:
    """The point of --point, or of --link with --at; `None` where nothing is given."""
    if name is not None:
        if link is not None or at is not None:
            raise RequestError("--point: a name or --link with --at, not both; give one of them")
        return name
    if link is None and at is None:
        return None
    if link is None or at is None:
        missing = "--at" if at is None else "--link"
        raise RequestError(f"{missing}: missing; give --point NAME, or --link with --at")
    return link_of("--link", link, linkage), three_numbers("--at", at, "a place", "-100,-90,-80")


def look_of(view: str | None, size: str | None, style: str | None) -> FigureLook:
    """How figures are drawn: --view, --size and --style."""
    from sevenbar.reporting.figures import FigureLook

    if view is None and size is None and style is None:
        return FigureLook()
    # matplotlib is needed from here on
    from sevenbar.drawing.style import check_style

    return FigureLook(
        None if view is None else view_of(view),
        None if size is None else _page("--size", size),
        None if style is None else check_style(style, "--style"),
    )


def view_of(text: str) -> str | tuple[float, float] | None:
    """The view of --view: a name, or elevation and azimuth [deg]."""
    from sevenbar.drawing.view import check_view

    asked: str | tuple[float, float] = text
    if "," in text:
        angles = [amount(word, sizes_of("deg"), "deg") for word in split_list(text)]
        if len(angles) == 2 and None not in angles:
            asked = angles[0] or 0.0, angles[1] or 0.0
    return check_view(asked, "--view")


def _page(option: str, text: str) -> tuple[float, float]:
    """Width and height [inch] of a text like 85x60mm; a plain number is in millimetres."""
    parts = with_common_unit(*parts) if len(parts := text.lower().split("x")) == 2 else None
    sides = [amount(part.strip(), sizes_of("in"), "mm") for part in parts or ()]
    if len(sides) != 2 or not all(side is not None and 0.5 <= side <= 60 for side in sides):
        raise RequestError(
            f"{option}: {shown(text)} is not a size; give width and height of 13 to 1524 mm, as in '85x60mm'"
        )
    return sides[0] or 0.0, sides[1] or 0.0


def film_of(fps: float | None, seconds: float | None, film: Path | None) -> dict[str, Any]:
    """Rate and length of --fps and --seconds, those that are given."""
    given = {name: value for name, value in (("fps", fps), ("seconds", seconds)) if value is not None}
    if given and film is None:
        raise RequestError(
            f"--{next(iter(given))}: a film is missing; give --animate, as in '--animate film.gif'"
        )
    return given


def angle(option: str, text: str) -> float:
    """The angle [rad] of a text; a plain number is in degrees."""
    value = amount_in(text, "rad", "deg")
    if value is None:
        raise RequestError(f"{option}: {shown(text)} is not an angle; give one as in {examples_of('rad')}")
    return value


def angles(option: str, text: str) -> tuple[float, float]:
    """The two angles [rad] of a range like 0:90deg, whose unit may stand at the end only."""
    return _ends(option, text, "rad", "deg", "0:90deg or 30deg:-60deg")


def lengths(option: str, text: str, unit: str) -> tuple[float, float]:
    """The two lengths [unit] of a range like 50:1000 or 5cm:1m, whose unit may stand at the end only."""
    return _ends(option, text, unit, unit, "50:1000 or 5cm:1m")


def numbers(option: str, text: str) -> tuple[float, float]:
    """The two numbers of a range like 0:1, 0:pi/2 or 0:90deg; an angle with a unit counts in radians."""
    if ends := split_range(text):
        low, high = map(constant_of, ends)
        if low is not None and high is not None:
            return low, high
    raise RequestError(
        f"{option}: {shown(text)} is not a range; give two values, as in 0:1, 0:pi/2 or 0:90deg"
    )


def limits_of(transmission: str, size: str | None, motion_type: str | None, unit: str) -> Limits:
    """What a design must keep; a size without a unit is in `unit`."""
    from sevenbar.design.limits import Limits

    ends = None if size is None else lengths("--size", size, unit)
    return Limits(angle("--transmission", transmission), ends, motion_type)


def _ends(option: str, text: str, unit: str, plain: str, example: str) -> tuple[float, float]:
    if ends := split_range(text):
        low, high = (amount_in(end, unit, plain) for end in ends)
        if low is not None and high is not None:
            return low, high
    raise RequestError(f"{option}: {shown(text)} is not a range; give two values, as in {example}")
