"""What forces, reactions, sizings and balances print of themselves, and their figures."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from sevenbar.curves.curve import Peak
from sevenbar.forces.counterweights import Balance, Counterweight
from sevenbar.forces.result import COMPONENTS, Forces, Reaction
from sevenbar.forces.shaking import Shaking
from sevenbar.forces.sizing import Bearing, Burden, Sizing
from sevenbar.reporting import force_words
from sevenbar.reporting.shown import Shown, number, rows_text
from sevenbar.text.printing import figure_of, lines, picture_of, text_of


@text_of.register(Forces)
def _(forces: Forces) -> str:
    forces = forces.within_stops or forces
    place = force_words.Places(forces)
    mass = sum(body.mass for body in forces.bodies.values())
    facts = [("acts", force_words.acting_text(forces.loading)), ("mass", f"{mass:.6g} kg" if mass else "")]
    facts += force_words.part_facts(forces)
    lost = int((~np.isfinite(forces.torque)).sum())
    peak = ""
    if lost < len(forces.torque):
        row = int(np.nanargmax(np.abs(forces.torque)))
        peak = f"{number(forces.torque[row])} {forces.unit} @ {place(float(forces.input[row]))}"
    dead = "dead-centre" in forces.status
    bound = f"no bound at dead centres of {forces.driver}" if dead else f"greatest of the rows {peak}"
    facts.append((f"input {force_words.quantity(forces)}", bound))
    if not forces.at_rest and not dead and lost < len(forces.torque):
        low, high = np.nanmin(forces.power), np.nanmax(forces.power)
        facts.append(("power", f"{number(float(low))} to {number(float(high))} W"))
    every = forces.reactions.values()
    scale = {
        word: float(np.nanmax([force_words.greatest(getattr(r, word)) for r in every] + [0.0]))
        for word in ("force", "moment")
    }
    for name, reaction in forces.reactions.items():
        facts.append((name, _of_joint(reaction, scale, bounded=not dead)))
    facts += force_words.spin_facts(forces)
    facts += [(label, said) for label, said in force_words.open_facts(forces) if label]
    facts.append(("checks", force_words.check_text(forces)))
    state = " at rest" if forces.at_rest else ""
    rows = rows_text(forces.status)
    return lines(f"Forces{state} of '{forces.heading}', driven by {forces.driver}: {rows}", facts)


def _of_joint(reaction: Reaction, scale: dict[str, float], *, bounded: bool) -> str:
    """What a joint bears at most, of the rows; nothing where it is rounding of the `scale`."""
    lost = [c for c, known in zip(COMPONENTS, reaction.determinate, strict=True) if not known]
    said = []
    if bounded:
        for word, unit, values in (("force", "N", reaction.force), ("moment", "N m", reaction.moment)):
            known = values[:, np.isfinite(values).any(axis=0)]
            size = force_words.greatest(np.linalg.norm(known, axis=1)) if known.shape[1] else 0.0
            if size > force_words.ROUNDING * scale[word]:
                part = "" if known.shape[1] == 3 else " of what is known"
                said.append(f"{word}{part} up to {number(size)} {unit}")
    return ", ".join(said + ([f"{' '.join(lost)} not determined"] if lost else []))


@text_of.register(Reaction)
def _(reaction: Reaction) -> str:
    facts = []
    both = ("N", reaction.force, COMPONENTS[3:]), ("N m", reaction.moment, COMPONENTS[:3])
    for unit, values, names in both:
        for name, own in zip(names, values.T, strict=True):
            known = own[np.isfinite(own)]
            ends = (
                f"{number(float(known.min()))} to {number(float(known.max()))} {unit}" if known.size else ""
            )
            facts.append((name, ends or "not determined"))
    if not reaction.determinate.all():
        facts.append(("", "equilibrium of rigid bodies leaves the others to elasticity"))
    rows = f"{len(reaction.force)} rows, in its own frame, of the link before on the link after"
    return lines(f"Reaction in {reaction.joint}: {rows}", facts)


@text_of.register(Sizing)
def _(result: Sizing) -> str:
    def at(peak: Peak | None, unit: str) -> str:
        return "" if peak is None else f"{number(peak.value)} {unit} @ {place(peak.input)}"

    place = Shown(result.input_unit)

    most, in_plane = (
        [
            f"{name} {number(burden.peak.value)} N"
            for name, bearing in result.bearings.items()
            if math.isfinite((burden := getattr(bearing, part)).peak.value)
        ]
        for part in ("force", "in_plane")
    )
    flywheel = ""
    if result.flywheel is not None:
        flywheel = f"{number(result.flywheel)} kg m^2 for an unevenness of {result.unevenness:g}"
    return lines(
        "Sizing of a drive",
        [
            ("peak force" if result.unit == "N" else "peak torque", at(result.peak_torque, result.unit)),
            (
                "rms, mean",
                f"{number(result.rms_torque)} {result.unit}, {number(result.mean_torque)} {result.unit}",
            ),
            ("peak power", at(result.peak_power, "W")),
            ("braking power", at(result.braking_power, "W")),
            ("fluctuation", f"{number(result.fluctuation)} J"),
            ("flywheel", flywheel),
            ("peak forces", ", ".join(most)),
            *([("in the plane", ", ".join(in_plane))] if in_plane else []),
            ("found", force_words.peaks_text(result)),
        ],
    )


@text_of.register(Bearing)
def _(bearing: Bearing) -> str:
    facts = []
    place = Shown(bearing.input_unit)
    for part, unit in force_words.LISTED.items():
        burden: Burden = getattr(bearing, part)
        if math.isfinite(burden.peak.value):
            peak = f"peak {number(burden.peak.value)} {unit} @ {place(burden.peak.input)}"
            facts.append((part.replace("_", " "), f"{peak}, cubic mean {number(burden.mean_cube)} {unit}"))
        elif part != "in_plane":
            facts.append((part, "not determined"))
    return lines("Loads of a bearing", facts)


@text_of.register(Shaking)
def _(result: Shaking) -> str:
    both = (
        ("force", result.force, result.rms_force, "N"),
        ("moment", result.moment, result.rms_moment, "N m"),
    )
    place = Shown(result.input_unit)
    facts = [
        (word, f"peak {number(peak.value)} {unit} @ {place(peak.input)}, rms {number(rms)} {unit}")
        for word, peak, rms, unit in both
    ]
    return lines("Shaking", facts)


@text_of.register(Balance)
def _(result: Balance) -> str:
    return lines("Counterweights", balance_facts(result))


def balance_facts(result: Balance) -> list[tuple[str, str]]:
    """The counterweights link by link, what they leave of the shaking, and how they were found."""
    facts = [(f"link {one.link}", _weight(one, result.length_unit)) for one in result.counterweights]
    after = result.after if result.after > force_words.ROUNDING * result.before else 0.0
    shaking = f"{result.measure} {number(result.before)} N before, {number(after)} N after"
    facts.append(("shaking", shaking))
    facts.append(("found", f"{result.status}; {result.rank} of {result.unknowns} numbers act"))
    facts.append(("idle", "; ".join(result.idle)))
    return facts


def _weight(one: Counterweight, unit: str) -> str:
    if not one.product:
        return "none"
    way = ", ".join(f"{x if abs(x) > force_words.ROUNDING else 0.0:.4g}" for x in one.direction)
    mass = "" if one.mass is None else f", {number(one.mass)} kg"
    return f"{number(one.product)} kg {unit} towards ({way}){mass}"


@figure_of.register(Forces)
def _(forces: Forces, *, kind: str = "torque", **options: Any) -> Any:
    from sevenbar.drawing.force_figures import figure_of_kind

    return figure_of_kind(forces, kind, options)


@picture_of.register(Forces)
def _(forces: Forces) -> Any:
    from sevenbar.drawing.force_figures import small

    return small(forces)
