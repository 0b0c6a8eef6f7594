"""The drawings of docs/conventions.md: the RSSR's frame, and Denavit and Hartenberg's four numbers.

python docs/drawings.py
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import sevenbar as sb

Floats = npt.NDArray[np.float64]

IMAGES = Path(__file__).parent / "images"

#: Colours of axes, links, what is measured, and hints.
AXIS, LINK, MEASURE, HINT = "#5b6770", "#1d5c96", "#b3452c", "#a9b2b8"


#: Of a drawing [in].
WIDTH = 7.6

#: Of the RSSR that is drawn, such that it has the pose drawn.
COUPLER = 662.0


class Drawing:
    """Lines and words in space, seen from a direction without perspective."""

    def __init__(self, azimuth: float, elevation: float, sheet: tuple[float, float, float, float]) -> None:
        """`azimuth` and `elevation` [rad] of the eye; left, right, lower and upper end of the `sheet`."""
        ca, sa, ce, se = math.cos(azimuth), math.sin(azimuth), math.cos(elevation), math.sin(elevation)
        self._view = np.array([[-sa, ca, 0.0], [-se * ca, -se * sa, ce]])
        left, right, low, high = sheet
        self.figure = Figure(figsize=(WIDTH, WIDTH * (high - low) / (right - left)))
        self.axes: Axes = self.figure.add_axes((0.0, 0.0, 1.0, 1.0), xlim=(left, right), ylim=(low, high))
        self.axes.set_aspect("equal")
        self.axes.axis("off")

    def seen(self, places: npt.ArrayLike) -> Floats:
        """Places (.., 3) on the sheet (.., 2)."""
        flat: Floats = np.asarray(places, dtype=np.float64) @ self._view.T
        return flat

    def line(self, places: npt.ArrayLike, colour: str, width: float = 1.2, style: str = "-") -> None:
        """A line through places (n, 3)."""
        flat = self.seen(places)
        self.axes.plot(flat[:, 0], flat[:, 1], style, color=colour, lw=width, solid_capstyle="round")

    def arrow(self, start: npt.ArrayLike, end: npt.ArrayLike, colour: str, both: bool = False) -> None:
        """An arrow from one place to another, with a head at both ends for a measure."""
        style = {
            "arrowstyle": "<|-|>" if both else "-|>",
            "color": colour,
            "lw": 1.1,
            "shrinkA": 0,
            "shrinkB": 0,
        }
        self.axes.annotate("", xy=tuple(self.seen(end)), xytext=tuple(self.seen(start)), arrowprops=style)

    def ball(self, place: npt.ArrayLike, colour: str = LINK) -> None:
        """A ball joint."""
        self.axes.plot(*self.seen(place), "o", color=colour, ms=7)

    def word(self, place: npt.ArrayLike, text: str, colour: str, at: tuple[float, float]) -> None:
        """A word, so many points right of and above a place."""
        self.axes.annotate(
            text, tuple(self.seen(place)), xytext=at, textcoords="offset points",
            ha="center", va="center", fontsize=10, color=colour,
        )  # fmt: skip

    def turn(self, centre: Floats, first: Floats, second: Floats, radius: float, end: float) -> Floats:
        """An arrow round an arc from `first` by an angle towards `second`; gives its middle."""
        angles = np.linspace(0.0, end, 40)[:, None]
        arc = centre + radius * (np.cos(angles) * first + np.sin(angles) * second)
        self.line(arc[:-3], MEASURE)
        self.arrow(arc[-5], arc[-1], MEASURE)
        middle: Floats = arc[len(arc) // 2]
        return middle

    def write(self, name: str) -> None:
        """Writes the drawing, with the same bytes each time."""
        settings: dict[Any, Any] = {"svg.hashsalt": name, "svg.fonttype": "none", "font.family": "sans-serif"}
        with mpl.rc_context(settings):
            self.figure.savefig(IMAGES / f"{name}.svg", metadata={"Date": None, "Creator": None})


def rssr_frame() -> None:
    """The paper's layout, with the linkage in a pose of its first circuit."""
    M, N, L1, L3, D = 700.0, 600.0, 230.0, 400.0, 200.0
    alpha, beta = math.radians(50), math.radians(56)
    linkage = sb.rssr(M=M, N=N, L1=L1, L3=L3, D=D, L2=COUPLER)
    circuit = min(linkage.motion(samples=36), key=lambda found: _apart(found, alpha, beta).min())
    row = int(_apart(circuit, alpha, beta).argmin())
    alpha, beta = circuit.input[row] % math.tau, circuit.output[row] % math.tau
    ball_a, ball_b = (circuit.point(link, (0.0, 0.0, 0.0)).position[row] for link in (2, 3))
    foot_a, foot_b = np.array([0.0, 0.0, N]), np.array([M, D, 0.0])
    x, y, z = np.eye(3)
    place = Drawing(math.radians(-56), math.radians(22), (-330.0, 1130.0, -500.0, 1000.0))
    for axis, length, text, at in ((x, 1040, "x", (8, -2)), (y, 560, "y", (8, 2)), (z, 1000, "z", (0, 9))):
        place.arrow(np.zeros(3), length * axis, AXIS)
        place.word(length * axis, text, AXIS, at)
    place.word(np.zeros(3), "O", AXIS, (-9, -6))
    place.line([foot_b - 330 * x, foot_b + 330 * x], AXIS, 1.0, "-.")
    turns = np.linspace(0.0, math.tau, 181)[:, None]
    place.line(foot_a + L1 * (np.cos(turns) * x + np.sin(turns) * y), HINT, 0.9, "--")
    place.line(foot_b + L3 * (np.cos(turns) * y + np.sin(turns) * z), HINT, 0.9, "--")
    for foot, zero, radius in ((foot_a, x, L1), (foot_b, y, L3)):
        place.line([foot, foot + radius * zero], HINT, 1.0)
    place.line([foot_a, ball_a, ball_b, foot_b], LINK, 3.2)
    for ball in (ball_a, ball_b):
        place.ball(ball)
    place.arrow(np.zeros(3), foot_a, MEASURE, both=True)
    place.word(0.55 * foot_a, "N", MEASURE, (-11, 0))
    place.arrow(np.zeros(3), M * x, MEASURE, both=True)
    place.word(0.45 * M * x, "M", MEASURE, (-2, -11))
    place.arrow(M * x, foot_b, MEASURE, both=True)
    place.word(M * x + 0.5 * D * y, "D", MEASURE, (9, -8))
    place.word(place.turn(foot_a, x, y, 0.55 * L1, alpha), "α", MEASURE, (10, -3))
    place.word(place.turn(foot_b, y, z, 0.45 * L3, beta), "β", MEASURE, (11, 4))
    place.word(0.5 * (foot_a + ball_a), "L1", LINK, (-2, 12))
    place.word(0.5 * (ball_a + ball_b), "L2", LINK, (6, 11))
    place.word(0.5 * (foot_b + ball_b), "L3", LINK, (14, 0))
    place.word(ball_a, "A", LINK, (0, 13))
    place.word(ball_b, "B", LINK, (11, 8))
    place.write("convention_rssr")


def _apart(circuit: sb.Circuit, alpha: float, beta: float) -> Floats:
    """How far the rows of a circuit are from a pose [rad]."""
    off = np.stack([circuit.input - alpha, circuit.output - beta])
    apart: Floats = np.linalg.norm(np.remainder(off + math.pi, math.tau) - math.pi, axis=0)
    return apart


def four_numbers() -> None:
    """Link i between the axes of joints i and i + 1, with its four numbers and the way to a point of it."""
    theta, offset, length, twist = math.radians(62), 1.25, 2.1, math.radians(48)
    x, y, z = np.eye(3)
    along = math.cos(theta) * x + math.sin(theta) * y
    across = np.cross(z, along)
    raised, end = offset * z, offset * z + length * along
    following = math.cos(twist) * z - math.sin(twist) * across
    place = Drawing(math.radians(-62), math.radians(24), (-2.5, 3.6, -1.1, 2.95))
    place.line([-0.9 * z, 2.9 * z], AXIS, 1.0, "-.")
    place.word(2.9 * z, "axis of joint i", AXIS, (0, 9))
    place.line([end - 1.1 * following, end + 1.9 * following], AXIS, 1.0, "-.")
    place.word(end + 1.9 * following, "axis of joint i + 1", AXIS, (26, 10))
    place.line([-2.1 * x, np.zeros(3)], HINT, 3.2)
    place.word(-1.35 * x, "link i - 1", AXIS, (0, -13))
    place.line([np.zeros(3), 1.0 * x], HINT, 1.0)
    place.line([np.zeros(3), 1.05 * along], HINT, 1.0)
    place.line([np.zeros(3), raised, end], LINK, 3.2)
    place.ball(np.zeros(3), AXIS)
    place.word(np.zeros(3), "place where link i - 1\nmeets the axis", AXIS, (-78, -34))
    place.word(raised + 0.62 * length * along, "link i", LINK, (-10, 12))
    place.word(0.5 * raised, "offset", MEASURE, (-25, 16))
    place.word(raised + 0.3 * length * along, "length", MEASURE, (5, -14))
    place.word(place.turn(np.zeros(3), x, y, 0.75, theta), "θ", MEASURE, (11, -2))
    place.line([end, end + 1.1 * z], HINT, 1.0)
    place.word(place.turn(end, z, -across, 0.85, twist), "twist", MEASURE, (9, 12))
    for direction, text, at in ((z, "u", (-9, 2)), (along, "v", (6, -8)), (np.cross(z, along), "w", (-4, 9))):
        place.arrow(np.zeros(3), 0.55 * direction, LINK)
        place.word(0.55 * direction, text, LINK, at)
    place.write("convention_dh")


if __name__ == "__main__":
    rssr_frame()
    four_numbers()
