"""Nets of several loops: rows of circuits, modes, whole motions, and what the command `analyze` takes."""

from __future__ import annotations

import sevenbar as sb
from evidence.benches.cases import nets_modes, nets_motion, nets_pylinkage, yardsticks
from evidence.benches.harness import Work, compare
from evidence.benches.outcome import Cell, Outcome, Table
from evidence.benches.setting import Setting

TITLE = "Nets of several loops"
ABOUT = """\
**Rows.** A circuit from a known pose at few and at many inputs: the difference is what rows cost, each with
values, velocities, accelerations and jerks of all joints, status, closure error and condition number; what
is left is following the circuit. The yardstick, the sine and cosine of as many numbers by NumPy, is measured
in the same process.

**pylinkage** places the pins of planar linkages dyad by dyad from one step of the crank to the next,
compiled by numba (`step_fast`), or with velocities and accelerations (`step_fast_with_kinematics`); its
first call, which compiles, is not timed. Sevenbar's call follows the circuit first and checks each row. *A
row* is the difference between many and few inputs. Differences are in sizes for places, relative to the
greatest for rates, of all pins that move and the foot.

**Modes** are all at one input, as a mean over 16 inputs near each other. *Start* is what the first call in a
new process takes more than the second: the starts of a block's family are computed once. **All circuits** are
`linkage.motion()`, which finds and counts them and follows each. **analyze** is the whole command, from the
file to the printed report, without the process. CPU time, one thread."""

#: Inputs in a turn, few and many.
SAMPLES = (3_600, 14_400)

#: Pins of a planar crank-rocker.
FOUR_BAR = (("crank", 0, 0), ("a", 6, 10), ("b", 30, 25), ("lever", 40, 0))


def linkages() -> dict[str, sb.Linkage]:
    """By name."""
    pins = [{"name": name, "kind": "R", "at": [x, y, 0], "axis": [0, 0, 1]} for name, x, y in FOUR_BAR]
    nets = {name: sb.load(name) for name in ("jansen", "klann", "watt")}
    return nets | {"planar four-bar": sb.from_axes(pins)}


def run(setting: Setting) -> Outcome:
    """All tables."""
    tables = [rows_of_circuits(setting), *nets_pylinkage.tables(setting), nets_modes.table(setting)]
    return Outcome(TITLE, ABOUT, [*tables, nets_motion.motions(setting), nets_motion.analyses(setting)])


def rows_of_circuits(setting: Setting) -> Table:
    """What one more row of a circuit costs."""
    sine = yardsticks.sine_and_cosine(SAMPLES[1])
    rows: list[list[Cell]] = []
    for name, linkage in linkages().items():
        pose = linkage.assembly_modes(0.3).q[0]
        counts = [len(linkage.circuit(pose, samples=samples).q) for samples in SAMPLES]
        works = [
            Work(str(samples), lambda a=linkage, q=pose, n=samples: a.circuit(q, samples=n))  # type: ignore[misc]
            for samples in SAMPLES
        ]
        short, long = (timing.median for timing in compare(works, rounds=setting.choose(15, 3)))
        row = (long - short) / (counts[1] - counts[0])
        follow = short - counts[0] * row
        rows.append([name, float(len(linkage.columns)), 1e9 * row, row / sine, 1e3 * follow, ""])
    columns = ["", "joints", "ns a row", "times a sine and cosine", "following it [ms]", "note"]
    return Table("One more row of a circuit", columns, rows)
