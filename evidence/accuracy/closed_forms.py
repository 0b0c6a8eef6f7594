"""Outputs with three derivatives by the textbooks' formulas, in forty digits, differentiated exactly.

Each formula takes the input as a series in time and gives all solutions of the output. Dimensions are those
that the gallery's files print, not what the program makes of them.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from dataclasses import dataclass

import mpmath as mp
import numpy as np

import sevenbar as sb
from evidence.accuracy.forty_digits import joint_errors
from evidence.accuracy.gallery_rows import seeded
from evidence.accuracy.quantiles import Row, summary
from evidence.accuracy.reference_loops import Loop
from evidence.accuracy.series import Series, acos, asin, atan2, cos_sin, sqrt
from sevenbar.description import gallery

#: Digits of every formula.
DIGITS = 40


@dataclass(frozen=True)
class ClosedForm:
    """A formula for the output of a linkage of the gallery, and where it comes from."""

    linkage: str
    source: str
    text: str
    outputs: Callable[[Series], list[Series]]


def _links(name: str, key: str) -> list[mp.mpf]:
    """The numbers of the file's Denavit-Hartenberg rows, twists in radians."""
    rows = tomllib.loads(gallery.text(name), parse_float=mp.mpf)["link"]
    values = [mp.mpf(row.get(key, 0)) for row in rows]
    return [mp.radians(value) for value in values] if key == "twist" else values


def _joint(name: str, joint: str, key: str) -> list[mp.mpf]:
    """Numbers of a drawn joint of the file."""
    joints = tomllib.loads(gallery.text(name), parse_float=mp.mpf)["joint"]
    return [mp.mpf(x) for x in next(j for j in joints if j["name"] == joint)[key]]


def both(a: Series, b: Series, c: Series) -> list[Series]:
    """Both solutions of `a cos x + b sin x = c`."""
    middle, half = atan2(b, a), acos(c / sqrt(a * a + b * b))
    return [middle + half, middle - half]


def rssr(alpha: Series) -> list[Series]:
    """`beta = asin(..) - atan2(L1 sin alpha - D, N)`, the paper's eq. (8), and its other branch."""
    table = {key: mp.mpf(value) for key, value in tomllib.loads(gallery.text("rssr"))["rssr"].items()}
    M, N, L1, L3, D = (table[key] for key in ("M", "N", "L1", "L3", "D"))
    c, s = cos_sin(alpha)
    y = L1 * s - D
    sine = asin((D**2 / 2 + L1 * (M * (1 - c) - D * s)) / (L3 * sqrt(N**2 + y * y)))
    back = atan2(y, Series.of(N))
    return [sine - back, mp.pi - sine - back]


def planar(phi: Series) -> list[Series]:
    """`|l4 + l1 e^(i phi) + l3 e^(i psi)| = l2`, theta_4 = -psi."""
    l1, l2, l3, l4 = _links("planar_4r", "length")
    c, s = cos_sin(phi)
    x, y = l4 + l1 * c, l1 * s
    return [-psi for psi in both(x, y, (l2**2 - l3**2 - (x * x + y * y)) / (2 * l3))]


def spherical(theta: Series) -> list[Series]:
    """The axes 2 and 3 stay `a2` apart, seen from the ground by its two sides."""
    a1, a2, a3, a4 = _links("spherical_4r", "twist")
    c, s = cos_sin(theta)
    x, y, z = mp.sin(a1) * s, -mp.sin(a1) * c, Series.of(mp.cos(a1))
    y, z = mp.cos(a4) * y - mp.sin(a4) * z, mp.sin(a4) * y + mp.cos(a4) * z
    return both(mp.sin(a3) * y, mp.sin(a3) * x, mp.cos(a2) - mp.cos(a3) * z)


def bennett(theta: Series) -> list[Series]:
    """`tan(theta_1 / 2) tan(theta_2 / 2) = sin((b + a) / 2) / sin((b - a) / 2)`, theta_4 = -theta_2."""
    a, b = _links("bennett", "twist")[:2]
    c, s = cos_sin(theta * mp.mpf("0.5"))
    return [-2 * atan2(mp.sin((b + a) / 2) * c, mp.sin((b - a) / 2) * s)]


def cardan(turn: Series) -> list[Series]:
    """`tan(out) = cos(angle of the shafts) tan(in)`, and half a turn on."""
    one, other = (_joint("universal_joint", joint, "axis") for joint in ("input_shaft", "output_shaft"))
    lengths = mp.sqrt(mp.fdot(one, one)) * mp.sqrt(mp.fdot(other, other))
    c, s = cos_sin(turn)
    out = atan2(abs(mp.fdot(one, other)) / lengths * s, c)
    return [out, out + mp.pi]


def clemens(turn: Series) -> list[Series]:
    """Both shafts turn alike, or half a turn apart."""
    return [turn, turn + mp.pi]


def slider(alpha: Series) -> list[Series]:
    """The slider is where a sphere about the crank's ball meets the line of the slide."""
    a, b = (_joint("rssp", joint, "at") for joint in ("ball_a", "ball_b"))
    axis = _joint("rssp", "slider", "axis")
    length = mp.sqrt(mp.fdot(axis, axis))
    along = [x / length for x in axis]
    coupler = mp.fsum((x - y) ** 2 for x, y in zip(a, b, strict=True))
    c, s = cos_sin(alpha)
    ball = [a[0] * c - a[1] * s, a[0] * s + a[1] * c, Series.of(a[2])]
    off = [place - moved for place, moved in zip(b, ball, strict=True)]
    middle = -_sum([x * w for x, w in zip(off, along, strict=True)])
    root = sqrt(middle * middle - _sum([x * x for x in off]) + coupler)
    return [middle + root, middle - root]


def drill(angle: Series) -> list[Series]:
    """The law of cosines gives the side that the screw lengthens; the spindle turns by it over the pitch."""
    pin, pivot = (_joint("screw_drill", joint, "at") for joint in ("pin", "pivot"))
    joints = tomllib.loads(gallery.text("screw_drill"), parse_float=mp.mpf)["joint"]
    pitch = mp.mpf(next(j["pitch"] for j in joints if j["name"] == "thread"))
    crank, ground = mp.sqrt(mp.fdot(pin, pin)), mp.sqrt(mp.fdot(pivot, pivot))
    drawn = mp.sqrt(mp.fsum((x - y) ** 2 for x, y in zip(pin, pivot, strict=True)))
    side = sqrt(crank**2 + ground**2 - 2 * crank * ground * cos_sin(angle)[1])
    return [(drawn - way * side) * 2 * mp.pi / pitch for way in (1, -1)]


def _sum(terms: list[Series]) -> Series:
    total = terms[0]
    for term in terms[1:]:
        total = total + term
    return total


FORMS = (
    ClosedForm("rssr", "Sun and Zhou, eq. (8), both branches", "beta = asin(..) - atan2(..)", rssr),
    ClosedForm("rsur", "the same: the rocker does not feel how the coupler spins", "as above", rssr),
    ClosedForm("planar_4r", "Freudenstein 1955", "l4 + l1 e^(i phi) + l3 e^(i psi) is l2 long", planar),
    ClosedForm("spherical_4r", "Chiang 1988", "the spherical law of cosines", spherical),
    ClosedForm("bennett", "Bennett 1903", "tan(t1 / 2) tan(t2 / 2) is constant", bennett),
    ClosedForm("universal_joint", "Hartenberg and Denavit 1964", "tan(out) = cos(angle) tan(in)", cardan),
    ClosedForm("five_bar", "Hunt 1973", "both shafts turn alike", clemens),
    ClosedForm("rssp", "Hartenberg and Denavit 1964", "sphere and line", slider),
    ClosedForm("screw_drill", "the law of cosines", "side = as drawn - pitch x turns", drill),
)


def measured(form: ClosedForm, count: int) -> dict[str, object]:
    """Quantiles of the errors of the output on every circuit, at `count` inputs drawn at random."""
    linkage = sb.load(form.linkage)
    rows = list(compared(form, linkage, count))
    return {
        "linkage": form.linkage,
        "source": form.source,
        "formula": form.text,
        "circuits": len({row.circuit for row in rows}),
        "output": summary(rows, "output"),
    }


def compared(form: ClosedForm, linkage: sb.Linkage, count: int) -> list[Row]:
    """Every row; a circuit takes the formula's solution that it begins on."""
    speed = linkage.drive.speed
    inputs = np.sort(seeded(form.linkage, 2).uniform(0, 2 * np.pi, size=count))
    rows = []
    for circuit in linkage.motion(law=sb.Law.of(np.arange(count), inputs, speed, 0.0, 0.0)):
        column = circuit.output_column
        turns = np.array([circuit.output_turns])
        units = np.where(turns, 1.0, Loop.of(linkage).size)
        values = (circuit.q, circuit.dq, circuit.ddq, circuit.dddq)
        pick = None
        for row in range(len(circuit.input)):
            got = np.array([[array[row, column]] for array in values])
            with mp.workdps(DIGITS):
                series = form.outputs(Series.of(float(circuit.input[row]), float(speed)))
                solutions = [solution.derivatives for solution in series]
                errors = [joint_errors(got, [exact], units, speed, turns) for exact in solutions]
            if pick is None:
                pick = int(np.argmin([each[0] for each in errors]))
            condition = float(circuit.condition[row])
            at = float(circuit.input[row])
            rows.append(Row(form.linkage, circuit.index, at, condition, np.inf, {"output": errors[pick]}))
    return rows
