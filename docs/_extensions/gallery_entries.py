"""The gallery: each linkage drawn and analysed when the site is built; its tables, which the pages have."""

import re
from collections import Counter
from pathlib import Path

import sevenbar as sb
from page_tables import code, table
from sevenbar.description import gallery
from sevenbar.reporting import report
from sevenbar.reporting.facts import facts_of
from sevenbar.reporting.shown import value_text

#: Where the pictures are written, below the pages' folder.
PICTURES = "_made/gallery"

#: Facts of the report that a gallery need not show.
LEFT_OUT = {"dimensions", "how found", "mobility", "closure error"}


def all_entries(pages: Path, _: str) -> str:
    """A section for each linkage."""
    (pages / PICTURES).mkdir(parents=True, exist_ok=True)
    return "\n".join(_section(name, sb.load(name).motion(), pages) for name in gallery.names())


def table_of_loops(_pages: Path, _: str) -> str:
    """A table of all single loops."""
    rows = []
    for name in gallery.loops():
        motion = sb.load(name).motion(36)
        loop, count = " ".join(motion.linkage.kind), str(len(motion.circuits))
        rows.append((motion.linkage.name, code(name), loop, motion.motion_type, count))
    return table(("linkage", "name", "loop", "motion type", "circuits"), rows)


def table_of_nets(_pages: Path, _: str) -> str:
    """A table of all linkages of several loops, without a motion, which takes seconds of some."""
    rows = []
    for name in gallery.nets():
        linkage = sb.load(name)
        counts = [str(len(part)) for part in (linkage.link_names, linkage.joints, linkage.rods)]
        rows.append((linkage.name, code(name), *counts, _solved(linkage)))
    return table(("linkage", "name", "links", "joints", "rods", "solved, the input held"), rows)


def _solved(linkage: sb.Linkage) -> str:
    """How many blocks there are of each kind, as in `3 dyads`."""
    kinds = [
        "dyad" if block.solver == "dyad" else f"block of {len(block.links)} links"
        for block in linkage.order.blocks
    ]
    return ", ".join(f"{count} {kind}{'s' * (count > 1)}" for kind, count in Counter(kinds).items())


def _section(name: str, motion: sb.Motion, pages: Path) -> str:
    picture = f"{PICTURES}/{name}.svg"
    drawn = motion.circuits[report.posed_circuit(motion) or 0]
    sb.plot.save(sb.plot.configuration(motion, circuit=drawn.index), pages / picture)
    text = gallery.text(name)
    remarks = re.match(r"(?:#.*\n)*", text)[0]
    origin = " ".join(line.lstrip("# ") for line in remarks.splitlines())
    facts = [(fact, value.replace("  ", ", ")) for fact, value in facts_of(motion) if fact not in LEFT_OUT]
    rows = [*facts, ("mobility", str(motion.mobility)), ("modes", _modes(motion, drawn))]
    parts = (
        f"({name})=",
        f"## {motion.linkage.name}",
        origin,
        f"![{motion.linkage.name}]({picture}){{width=34em}}",
        table(("", code(name)), rows),
        f"<details><summary><code>sevenbar gallery {name}</code></summary>",
        f"```toml\n{text}```",
        "</details>\n",
    )
    return "\n\n".join(parts)


def _modes(motion: sb.Motion, drawn: sb.Circuit) -> str:
    """How many modes there are at an input of the circuit that is drawn, a third of the way along it."""
    column = drawn.input_column
    value = float(drawn.input[len(drawn.input) // 3])
    modes = motion.linkage.assembly_modes(value, input=motion.input)
    return f"{len(modes)} at {motion.input} = {value_text(motion.linkage, column, value)}"
