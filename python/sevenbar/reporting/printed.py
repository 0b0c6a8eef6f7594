"""The pages of a motion and of assembly modes as rich prints them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING

from rich.box import SIMPLE_HEAD
from rich.console import Console, ConsoleOptions, RenderableType, RenderResult
from rich.table import Table
from rich.text import Text

from sevenbar.kinematics.circuits.modes import Modes
from sevenbar.kinematics.circuits.motion import Motion, Solvable
from sevenbar.reporting.facts import completeness_text, idle_text
from sevenbar.reporting.how_found import left_open
from sevenbar.reporting.page import Facts
from sevenbar.reporting.pose_text import driven_text, rates_sheets
from sevenbar.reporting.shown import value_text
from sevenbar.reporting.summary import GAP, Sheet, modes_sheets, summary
from sevenbar.text.words import language, say, spoken

if TYPE_CHECKING:
    from sevenbar.kinematics.circuits.poses_at import PosesAt


class _Page:
    """A page that is laid out for the width in which it is printed, in the language it was made in."""

    def __init__(self, parts: Callable[[int], Iterable[RenderableType]]) -> None:
        self.parts, self.language = parts, spoken()

    def __rich_console__(self, _console: Console, options: ConsoleOptions) -> RenderResult:
        with language(self.language):
            made = list(self.parts(options.max_width))
        yield from made


def motion_page(motion: Motion, *, ranges: bool = False, short: bool = False) -> RenderableType:
    """The report of a motion; angles in degrees; with `ranges` of all joints; or a `short` one."""

    def parts(width: int) -> Iterator[RenderableType]:
        page = summary(motion, width, ranges=ranges, short=short)
        facts = Facts()
        facts.add_all(page.facts, bold=[say("motion type")])
        yield Text(page.title, style="bold underline")
        yield facts.grid
        for sheet in page.sheets:
            yield Text()
            yield _table(sheet)
            if sheet.note:
                yield Text(sheet.note, style="dim")

    return _Page(parts)


def modes_page(
    linkage: Solvable, column: int, modes: Modes, poses: PosesAt | None = None, limit: float | None = None
) -> RenderableType:
    """All assembly modes at a value of a column, a row each, and their rates in `poses`.

    `limit` is the nearest value up to which the loop closes, where it does not close at this one.
    """
    own = [] if poses is None else [poses.nearest(q) for q in modes.q]

    def parts(width: int) -> Iterator[RenderableType]:
        yield Text(linkage.heading, style="bold underline")
        count = len(modes)
        yield Text(
            say(
                "{count} assembly mode{s} at {joint} = {value}, {completeness}",
                count=count or say("no"), s="s" * (count != 1), joint=linkage.columns[column],
                value=value_text(linkage, column, modes.input),
                completeness=completeness_text(modes.completeness, curve=modes.on_curve is not None),
            )
        )  # fmt: skip
        if modes.open_by.size:
            yield Text(left_open(modes.open_by, modes.agree))
        if limit is not None:
            nearest = value_text(linkage, column, limit)
            yield Text(
                say("the nearest limit of {joint} is {value}", joint=linkage.columns[column], value=nearest)
            )
        for sheet in modes_sheets(linkage, modes, width) if count else ():
            yield Text()
            yield _table(sheet)
        known = [pose for pose in own if pose is not None]
        if not known:
            return
        yield Text()
        yield Text(
            say(
                "rates with {driven}, along x, y, z of the report frame",
                driven=driven_text(linkage, known[0]),
            )
        )
        if len(known) < len(own):
            others = ", ".join(str(i) for i, pose in enumerate(own) if pose is None)
            yield Text(say("no motion leads through mode {modes}", modes=others))
        if linkage.idle:
            yield Text(idle_text(linkage.idle))
        for sheet in rates_sheets(linkage, [(str(i), pose) for i, pose in enumerate(own)], width):
            yield Text()
            yield _table(sheet)

    return _Page(parts)


def _table(sheet: Sheet) -> Table:
    # of the gap the box itself puts one space between columns
    table = Table(box=SIMPLE_HEAD, pad_edge=False, show_edge=False, padding=(0, GAP - 1, 0, 0))
    for place, head in enumerate(sheet.heads):
        right = place in sheet.right
        table.add_column(Text(head), justify="right" if right else "left", overflow="fold", no_wrap=right)
    # rows of several lines are kept apart
    is_tall = any("\n" in cell for row in sheet.rows for cell in row)
    for row in sheet.rows:
        table.add_row(*map(Text, row))
        if is_tall and row is not sheet.rows[-1]:
            table.add_row()
    return table
