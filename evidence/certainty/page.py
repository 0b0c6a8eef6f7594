"""The page on what is certain, from the rows of a run: it has no number that the run did not count."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import groupby
from typing import Any

from evidence.certainty import changes, counted, moving, narrow, nets, spatial_nets
from evidence.certainty.family import Family, Row
from evidence.circumstances import in_words
from evidence.markdown import table

#: What each linkage of a part must do, and by what that is decided.
ASKED = {
    narrow.PART: (
        "Joints of one linear complex have a pose that is isolated. One link moved up opens it on one "
        f"side to a circuit {narrow.WIDTHS[0]:g} to {narrow.WIDTHS[1]:g} degrees wide in the input, and "
        "on the other to nothing. Both sides are analysed: circuits must be `counted`, the narrow one be "
        "found on the right side only, and be as wide as a walk along the loop that shares no formula "
        f"with the core, to {narrow.ALIKE:.0%}. Of four-bars the width is that of the cosine law in 50 "
        f"digits, to {narrow.EXACT:g} of it."
    ),
    counted.PART: (
        "Random linkages by the general way: circuits must be `counted`, that is the account of branch "
        f"points closes in every range; and all modes at each of {counted.INPUTS} inputs, found without "
        f"regard to circuits, must lie on one, to {counted.ON_CIRCUIT:g} rad. A slide as input is driven "
        f"over {2 * counted.FAR_INPUT:g} sizes, and modes with slides beyond {counted.FARTHEST:g} sizes "
        "are left out, since circuits are followed to 50. An account takes another circle where a mode is "
        "lost on one, or a range does not balance."
    ),
    changes.PART: (
        "Linkages with change points: the motion type must be `change-point` where two limits of the "
        f"input are within {changes.NEAR:g} rad, and be that only where two limits of input or output, "
        f"complex ones counted, are within {changes.APART:g}. That is decided in 50 digits by the cosine "
        "laws, for a 7R with a node by its second-order form; of Bricard's loops it is left open. All "
        f"modes at {len(range(changes.FIRST, changes.ROWS, changes.EVERY))} inputs must lie on a circuit "
        f"or at a change point, to {changes.ON_CIRCUIT:g}, and no pose on two circuits."
    ),
    changes.NEARBY: (
        "The same, with one number off by 1e-13 to 1e-5 to either side; RSSRs whose coupler is a "
        "stationary distance of both circles, off by 1e-16 to 1e-2, by a polynomial of degree four. A "
        f"circuit narrower than {changes.NEAR:g} rad may be reported as an isolated pose."
    ),
    moving.SHAKY: (
        "Loops whose drawn pose has infinitesimal freedoms, and no velocity for which all second-order "
        "forms vanish: they must be `rigid`, with no finite freedom in `mobility`."
    ),
    moving.MOVING: ("Families that are known to move: circuits must be found, and one finite freedom."),
    moving.SCREWS: (
        "Loops whose freedom follows from the subgroups of their screws, in numbers of one, two or nine "
        "digits: `mobility` and the motion by every input that can drive must say the same."
    ),
    nets.PART: (
        "Planar nets of pins and slides, half of them in decimals of one digit. Damped steps from "
        f"{nets.STARTS} random places and turns of all links, with no tree and no blocks, find poses at "
        f"{nets.INPUTS} inputs: each isolated one must be among the modes. Where the input turns and no "
        f"change point is met, each mode at {nets.ROWS} inputs must lie on exactly one circuit."
    ),
    spatial_nets.PART: (
        "The same in space: damped steps over a quaternion and a place of every link, with rows of vectors "
        "that must be equal, so that no axis is turned over. The search is weak where several links are "
        "solved together; each mode must close in its rows, too."
    ),
}


def line(name: str, row: Row) -> str:
    """A line for the terminal."""
    return f"{name:52} {row.linkages:5} linkages  {len(row.differences):4} differences  {_seen(row)}"


def written(families: Mapping[str, Family], rows: Mapping[str, Row], made: Mapping[str, Any]) -> str:
    """The page as Markdown."""
    linkages = sum(row.linkages for row in rows.values())
    whole = sum(family.count for family in families.values())
    done = f"{linkages:,}" if linkages == whole else f"{linkages:,} of the {whole:,}"
    minutes = sum(row.seconds for row in rows.values()) / 60
    different = sum(len(row.differences) for row in rows.values())
    parts = [
        "# Nothing lost",
        "Made by `python -m evidence.certainty`; not edited by hand. "
        f"{in_words(made)}. {done} linkages from seed {made['seed']} in {minutes:.0f} minutes of one core; "
        f"{different:,} differences.",
        "Each linkage follows from the seed, its family and its number; "
        "`--again FAMILY CASE` judges one anew.",
    ]
    for part, group in groupby(families.values(), lambda family: family.part):
        parts += [f"## {part}", ASKED[part], _table([(f, rows[f.name]) for f in group])]
    found = [(name, str(n), what) for name, row in rows.items() for n, what in row.differences]
    parts += ["## Differences", table(("family", "case", "what"), found) if found else "None."]
    return "\n\n".join(parts) + "\n"


def _table(rows: list[tuple[Family, Row]]) -> str:
    return table(
        ("family", "linkages", "differences", "seen"),
        [(f.name, f"{row.linkages:,}", f"{len(row.differences):,}", _seen(row)) for f, row in rows],
    )


def _seen(row: Row) -> str:
    return ", ".join(f"{count:,} {what}" for what, count in sorted(row.seen.items()))
