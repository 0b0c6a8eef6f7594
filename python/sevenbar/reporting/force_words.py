"""What acts on a linkage and what follows, in words: facts of a report and lines that results print."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.curves.curve import Peak
from sevenbar.curves.timed_rows import shares_of
from sevenbar.forces.acting import Load, Spring
from sevenbar.forces.bodies import Body
from sevenbar.forces.heard import heard
from sevenbar.forces.loading import Loading
from sevenbar.forces.result import COMPONENTS, Forces
from sevenbar.forces.shaking import Shaking
from sevenbar.forces.sizing import WITHHELD, Sizing
from sevenbar.reporting.shown import Shown, number
from sevenbar.text.words import retold, say

#: A force or moment below this part of the greatest is rounding.
ROUNDING = 1e-9

#: The parts of a bearing's load that are listed, with their units.
LISTED = {"force": "N", "radial": "N", "axial": "N", "tilting": "N m", "turning": "N m", "in_plane": "N"}

#: What a cell has for a part that equilibrium of rigid bodies does not determine.
OPEN = "-"

#: What a file without anything that acts lacks, with a place for a word of the file.
NOTHING_ACTS = """\
nothing in {place} has a mass and nothing acts; write a body, a load or a spring into it, as in
  [forces]
  gravity = [0, 0, -9.80665]

  [[body]]
  link = 2
  mass = 1.3
  solid = "rod\""""


class Places:
    """How an input is written at which something is met: in degrees, or the length unit."""

    def __init__(self, forces: Forces) -> None:
        #: A value of the input as it is, turns and all.
        self.plain = self._show = Shown(forces.length_unit if forces.slides else "rad")
        # of a cycle of several turns the place says which turn
        self._whole = not forces.slides and abs(forces.period or 0.0) < 1.5 * math.tau

    def __call__(self, input: float) -> str:
        """An input with its unit."""
        return self._show(input, whole=self._whole)

    def at(self, peak: Peak, unit: str) -> str:
        """A peak with its place: `20.3 N m @ 123.400°`."""
        return f"{number(peak.value)} {unit} @ {self(peak.input)}"


def body_text(body: Body, mass: float | None) -> str:
    """A body by its mass, and where centre and inertia come from; `mass` [kg] of one that is drawn."""
    shown = f"{body.mass or mass or math.nan:.6g} kg"
    if body.density is not None and not mass:
        # one of several, whose masses are known together
        shown = f"{body.density:.6g} kg/m^3"
    if body.solid == "rod":
        return say("{mass}, a uniform rod between its joints", mass=shown)
    if body.solid == "cylinder":
        return say("{mass}, a uniform cylinder", mass=shown)
    if body.solid == "box":
        return say("{mass}, a uniform box", mass=shown)
    if body.solid == "drawn":
        drawn = say("{mass}, the solids that exports draw", mass=shown)
        return drawn if body.mass else say("{drawn}, of steel", drawn=drawn)
    centre = say("{mass}, centre {place}", mass=shown, place=triple_text(body.centre or ()))
    return centre if body.tensor.any() else say("{body}, a point", body=centre)


def load_text(load: Load, shown: Callable[[float], str]) -> str:
    """A load in words; `shown` writes a value of the input."""
    parts = []
    if any(load.force):
        force, at = triple_text(load.force), triple_text(load.at or ())
        parts.append(say("force {force} N at {place}", force=force, place=at))
    if any(load.torque):
        parts.append(say("torque {torque} N m", torque=triple_text(load.torque)))
    text = say("{loads} on link {link}", loads=say(" and ").join(parts), link=load.link)
    if load.axes != "ground":
        text = say("{load}, turning with the link", load=text)
    if load.between is not None:
        low, high = map(shown, load.between)
        text = say("{load}, from {low} to {high} of the input", load=text, low=low, high=high)
    elif load.table is not None:
        inputs = load.table[0]
        low, high = shown(inputs[0]), shown(inputs[-1])
        text = say(
            "{load}, by a table of {count} rows from {low} to {high}",
            load=text, count=len(inputs), low=low, high=high,
        )  # fmt: skip
    return say("{word}: {meaning}", word=load.name, meaning=text) if load.name else text


def spring_text(spring: Spring, unit: str, *, slides: bool) -> str:
    """A spring in words; `unit` that of lengths, `slides` whether its joint does."""
    force, by = ("N", unit) if spring.links is not None or slides else ("N m", "rad")
    if spring.links is not None:
        first, second = spring.links
        where = say("links {first} and {second}", first=first, second=second)
        free = f"{spring.length:.6g} {unit}"
    else:
        where = say("joint {joint}", joint=spring.joint)
        free = f"{spring.length:.6g} {unit}" if slides else Shown("rad")(spring.length)
    parts = []
    if spring.stiffness:
        stiffness = f"{spring.stiffness:.6g} {force}/{by}"
        parts.append(say("{stiffness}, free at {length}", stiffness=stiffness, length=free))
    if spring.damping:
        parts.append(say("damping {damping}", damping=f"{spring.damping:.6g} {force} s/{by}"))
    text = say("{word}: {meaning}", word=where, meaning=say(", ").join(parts))
    return say("{word}: {meaning}", word=spring.name, meaning=text) if spring.name else text


def triple_text(values: Sequence[float]) -> str:
    """Three numbers in brackets."""
    return f"({', '.join(f'{value + 0.0:.6g}' for value in values)})"


def acting_text(loading: Loading) -> str:
    """What acts, counted."""
    bodies = sum(map(len, loading.bodies.values()))
    loads, springs = len(loading.loads), len(loading.springs)
    what = [
        (bodies == 1, say("1 body")),
        (bodies > 1, say("{count} bodies", count=bodies)),
        (loads == 1, say("1 load")),
        (loads > 1, say("{count} loads", count=loads)),
        (springs == 1, say("1 spring")),
        (springs > 1, say("{count} springs", count=springs)),
        (any(loading.gravity), say("gravity")),
    ]
    return say(", ").join(text for there, text in what if there)


def acting_facts(forces: Forces, sliding: Sequence[str]) -> list[tuple[str, str]]:
    """What acts, a line each; `sliding` are the joints that slide."""
    loading, place = forces.loading, Places(forces)
    lines = []
    for link, bodies in sorted(loading.bodies.items()):
        mass = forces.bodies[link].mass if len(bodies) == 1 else None
        lines += [(say("link {number}", number=link), body_text(body, mass)) for body in bodies]
    for i, load in enumerate(loading.loads, 1):
        lines.append((say("load {number}", number=i), load_text(load, place.plain)))
    for i, spring in enumerate(loading.springs, 1):
        text = spring_text(spring, forces.length_unit, slides=spring.joint in sliding)
        lines.append((say("spring {number}", number=i), text))
    pull = f"{triple_text(loading.gravity)} m/s^2" if any(loading.gravity) else say("none")
    return [*lines, (say("gravity"), pull)]


def part_facts(forces: Forces, others: Sequence[Forces] = ()) -> list[tuple[str, str]]:
    """The part between stops that the rows are, and the other ones with their peaks."""
    if forces.part is None:
        return []
    facts = [(say("within the stops"), part_text(forces))]
    for one in others:
        result = one.sizing()
        peak = no_peak(one) if result is None else Places(one).at(result.peak_torque, one.unit)
        text = say("{part}, pass {number}: {peak}", part=part_text(one), number=int(one.branch[0]), peak=peak)
        facts.append((say("another part"), text))
    return facts


def part_text(forces: Forces) -> str:
    """A part between stops: "crank from 0.000° to 65.000° (range of crank)"."""
    part, place = forces.part, Places(forces)
    assert part is not None
    by = say("; ").join(dict.fromkeys(retold(stop) for stop in (part.first_stop, part.last_stop) if stop))
    return say(
        "{joint} from {low} to {high} ({stop})",
        joint=forces.driver, low=place(part.start), high=place(part.end), stop=by,
    )  # fmt: skip


def no_peak(forces: Forces) -> str:
    """Why no peaks are found; empty where there are."""
    own = forces.within_stops
    if own is None:
        return say("no peak: no pose of this circuit is within the stops")
    if own is not forces:
        return no_peak(own)
    if forces.part is not None and forces.through_change_points:
        return say("no peak: what passes change points from stop to stop is not sized; see the rows")
    lost = ~np.isfinite(forces.torque)
    if forces.through_change_points and forces.periodic and forces.loading.breaks(turns=1):
        return say(
            "no peak: loads that set in or end are not sized on a circuit that passes change points; "
            "see the rows"
        )
    if not lost.any() and forces.periodic:
        if forces.unclosed > WITHHELD:
            return say(
                "no peak: next to a limit of {joint} the circuit is not followed to enough digits: power "
                "closes along the cycle to {value:.1e} of the peak only",
                joint=forces.driver, value=forces.unclosed,
            )  # fmt: skip
        return say(
            "no peak: next to a limit the {quantity} is too sharp to be followed, and more than a thousandth "
            "of it may be missed",
            quantity=say(quantity(forces)),
        )
    turns_back = forces.part is not None and forces.between is None
    if not (lost.any() or turns_back):
        return ""
    dead = np.unique(forces.status[lost])
    if "dead-centre" in dead or turns_back:
        return say(
            "no peak: the {quantity} grows without bound at the dead centres of {joint}; "
            "drive it by a law that stays off them, or another joint",
            quantity=say(quantity(forces)),
            joint=forces.driver,
        )
    return say(
        "no peak: {count} of {rows} rows have no value ({status}); drive it by a law that stays off them",
        count=int(lost.sum()),
        rows=len(lost),
        status=", ".join(map(str, dead)),
    )


def quantity(forces: Forces) -> str:
    """What the input gives: a torque, or as it slides a force."""
    return "force" if forces.slides else "torque"


def drive_label(forces: Forces) -> str:
    """What the line of what the drive has to give is called."""
    return say("input force") if forces.slides else say("input torque")


def drive_facts(forces: Forces, result: Sizing | None) -> list[tuple[str, str]]:
    """What the drive has to give: torque, power, energy, flywheel."""
    what, unit = drive_label(forces), forces.unit
    if result is None:
        return [(what, no_peak(forces))]
    place = Places(forces)
    if not result.peak_torque.value:
        idle = [(what, f"0 {unit}"), *([] if forces.at_rest else [(say("power"), "0 W")])]
        return [*idle, *_flywheel_facts(result)]
    rms, mean = f"{number(result.rms_torque)} {unit}", f"{number(result.mean_torque)} {unit}"
    facts = [
        (what, say("peak {value}", value=place.at(result.peak_torque, unit))),
        ("", say("rms {rms}, mean {mean}", rms=rms, mean=mean)),
        ("", sign_text(forces)),
    ]
    if forces.at_rest:
        return facts
    braking = say("no braking")
    if result.braking_power is not None:
        braking = say("braking {value}", value=place.at(result.braking_power, "W"))
    peak = say("peak {value}", value=place.at(result.peak_power, "W"))
    facts.append((say("power"), say(", ").join([peak, braking])))
    average = _mean_power(forces, result)
    mean = say("mean {power} W", power=number(average))
    facts.append(("", say("{mean}: the linkage drives its input", mean=mean) if average < 0 else mean))
    # from stop to stop as round a cycle
    steady = say("torque") if forces.periodic or forces.part is not None else say("power")
    energy = say(
        "fluctuates by {energy} J about a drive of constant {steady}: fastest at {fastest}, "
        "slowest at {slowest}",
        energy=number(result.fluctuation), steady=steady, fastest=place(result.fastest),
        slowest=place(result.slowest),
    )  # fmt: skip
    if result.fluctuation:
        facts.append((say("energy"), energy))
    return facts + _flywheel_facts(result)


def sign_text(forces: Forces) -> str:
    """Which way a positive torque, or force, of the input turns it."""
    if forces.slides:
        return say("positive: pushes {joint} as its way counts", joint=forces.driver)
    return say("positive: turns {joint} as its angle counts", joint=forces.driver)


def _flywheel_facts(result: Sizing) -> list[tuple[str, str]]:
    if result.flywheel is None:
        return []
    wheel = say(
        "{inertia} kg m^2 at the input for an unevenness of {unevenness:g}",
        inertia=number(result.flywheel), unevenness=result.unevenness,
    )  # fmt: skip
    return [(say("flywheel"), wheel)]


def _mean_power(forces: Forces, result: Sizing) -> float:
    """The mean power [W] by time, 0 where it is rounding."""
    if forces.periodic or forces.part is not None:
        # at one speed that of the mean torque, which sees change points and jumps between the rows
        speed = forces.even_speed * forces.metre
        mean, most = speed * result.mean_torque, abs(speed * result.peak_torque.value)
    else:
        mean, most = float(shares_of(forces.time) @ forces.power), float(np.abs(forces.power).max())
    return heard(mean, most)


def spin_facts(forces: Forces) -> list[tuple[str, str]]:
    """What holds links that spin idly: nothing for a rod, else a moment that no ball gives."""
    facts = []
    for link, most in forces.idle_spin.items():
        text = say("not held: its body is a rod, symmetric about the line of its balls, or none")
        if most:
            text = say(
                "the rule that holds it gives up to {moment} N m that no ball gives; without a guide "
                "the link turns about the line of its balls, and these forces are not its own",
                moment=number(most),
            )
        facts.append((say("idle spin"), say("{word}: {meaning}", word=retold(link), meaning=text)))
    return facts


def free_spin_facts(spin: Mapping[str, float]) -> list[tuple[str, str]]:
    """The same of a free motion and of equilibria, where the spin moves something."""
    facts = []
    for link, most in spin.items():
        if most:
            text = say(
                "the rule that holds it gives up to {moment} N m that no ball gives; without a guide "
                "the link turns about the line of its balls, and neither this motion nor these equilibria "
                "are its own",
                moment=number(most),
            )
            facts.append((say("idle spin"), say("{word}: {meaning}", word=retold(link), meaning=text)))
    return facts


def open_facts(forces: Forces) -> list[tuple[str, str]]:
    """What equilibrium of rigid bodies does not determine, by the redundant constraints."""
    if not forces.indeterminate:
        return []
    parts: dict[tuple[str, ...], list[str]] = {}
    for name, reaction in forces.reactions.items():
        lost = tuple(c for c, known in zip(COMPONENTS, reaction.determinate, strict=True) if not known)
        parts.setdefault(lost, []).append(name)
    everywhere = len(parts) == 1
    listed = [
        say("{components} in every joint", components=", ".join(lost))
        if everywhere
        else say("{components} of {joints}", components=", ".join(lost), joints=", ".join(joints))
        for lost, joints in parts.items()
        if lost
    ]
    what = say("; ").join(map(retold, forces.indeterminate))
    together = say(
        "{components}; the joints share {what}, and rigid bodies do not say how",
        what=what, components=say("; ").join(listed),
    )  # fmt: skip
    facts = [
        (say("not determined"), together),
        ("", say("these depend on clearances and elasticity; one joint with more freedom determines them")),
    ]
    if alone := known_alone(forces):
        facts.append(
            ("", say("across its axis a joint has one known force: {forces}", forces=say(", ").join(alone)))
        )
    return facts


def unbounded_facts(forces: Forces, result: Sizing | None) -> list[tuple[str, str]]:
    """Joints whose forces have no bound at the circuit's change points."""
    if result is None or not forces.through_change_points:
        return []
    lost = [
        name
        for name, bearing in result.bearings.items()
        if forces.reactions[name].determinate.any()
        and not any(math.isfinite(getattr(bearing, part).peak.value) for part in LISTED)
    ]
    text = say(
        "forces in {joints} grow without bound at the change points, where a link in line with its "
        "neighbour cannot drive it; the torque does not",
        joints=", ".join(lost),
    )
    return [(say("no bound"), text)] if lost else []


def known_alone(forces: Forces) -> list[str]:
    """Forces square to a joint's axis that are determined while the other one is not."""
    result = []
    for name, reaction in forces.reactions.items():
        x, y = reaction.determinate[3:5]
        if x != y:
            which = 0 if x else 1
            size = f"{number(greatest(reaction.force[:, which]))} N"
            known = COMPONENTS[3 + which]
            result.append(say("{force} of {joint}, up to {size}", force=known, joint=name, size=size))
    return result


def shaking_facts(forces: Forces, result: Shaking | None) -> list[tuple[str, str]]:
    """Shaking force and moment, peaks and root mean squares."""
    if result is None:
        return []
    place = Places(forces)
    force = {"value": place.at(result.force, "N"), "rms": f"{number(result.rms_force)} N"}
    moment = {"value": place.at(result.moment, "N m"), "rms": f"{number(result.rms_moment)} N m"}
    return [
        (say("shaking force"), say("peak {value}, rms {rms}", **force)),
        (say("moment"), say("about the origin: peak {value}, rms {rms}", **moment)),
    ]


def check_values(forces: Forces) -> dict[str, float | None]:
    """The checks of a result, each an error as a part of a peak; `None` where one cannot be made."""
    return {"power": forces.balance, "ground": forces.ground_balance, "work": forces.work}


def check_text(forces: Forces) -> str:
    """The checks in words."""
    values = check_values(forces)
    words = {
        "power": say("torque is the slope of potential energy")
        if forces.at_rest
        else say("power closes along the cycle"),
        "ground": say("the ground bears weights, loads and shaking"),
        "work": say("work of a cycle"),
    }
    made = [
        say("{check} to {value:.1e}", check=words[key], value=value)
        for key, value in values.items()
        if value is not None
    ]
    return say("{checks} of the peak", checks=say(", ").join(made)) if made else ""


def peaks_text(sizing: Sizing | None, *, law: bool = False, part: bool = False) -> str:
    """How peaks were found; `law`: the rows are those of one; `part`: from stop to stop."""
    if sizing is None:
        return ""
    match sizing.found:
        case "series":
            return say(
                "by a series through all rows, peaks between them; what the rows may miss is {tail:.0e} of "
                "the peak",
                tail=sizing.tail,
            )
        case "refined":
            return say(
                "by polynomials over pieces of the cycle, the finer the sharper it is; what they may miss is "
                "{tail:.0e} of the peak",
                tail=sizing.tail,
            )
        case "pieces" if part:
            return say("from stop to stop, peaks within, at the stops, and where loads set in or end")
        case "pieces":
            return say("between the inputs at which loads set in or end, peaks within and at them")
        case _ if law:
            return say(
                "of the rows as they are, those of the law: its accelerations are as good as its table"
            )
        case _:
            return say("of the rows as they are")


def greatest(values: Floats) -> float:
    """The greatest size of known values, NaN where none is known."""
    known = np.abs(values[np.isfinite(values)])
    return float(known.max()) if known.size else math.nan
