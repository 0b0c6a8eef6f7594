"""All forces of one turn of the 7R paper's linkage, next to its motion alone and Exudyn's run."""

from __future__ import annotations

import math
import time

import numpy as np

import sevenbar as sb
from evidence.benches.harness import Timing, Work, compare, spread
from evidence.benches.outcome import Cell, Outcome, Table
from evidence.benches.peers import AbsentError, reason_of
from evidence.benches.setting import Setting
from sevenbar.forces.bodies import Body
from sevenbar.kinematics.circuits.circuit import Circuit

TITLE = "The 7R paper's linkage: forces"
ABOUT = """\
360 inputs of circuit 0 with a body on each link and its weight: the torque, the reaction in every joint
with what equilibrium determines, energies, shaking (`circuit.forces`), and the motion alone
(`linkage.circuit`: angles, velocities, accelerations, jerks). Exudyn's run is `sevenbar simulate`'s for
the same turn with the same bodies, without the steps ahead of it; its error falls with the square of its
steps: *torque off* is the greatest difference, in parts of the greatest torque. CPU time, one thread."""

SAMPLES = 360

#: Steps of Exudyn for the turn.
STEPS = (360, 1800, 3600)

#: Mass [kg] and radius of gyration [mm] of each body.
MASS, GYRATION = 1.0, 50.0


def run(setting: Setting) -> Outcome:
    """One table."""
    linkage = loaded()
    circuit = linkage.motion(SAMPLES).circuits[0]
    peak = float(np.abs(circuit.forces().torque).max())

    def motion() -> Circuit:
        return linkage.circuit(circuit.q[0], samples=SAMPLES)

    works = [
        Work("motion alone", motion, note="`linkage.circuit`"),
        Work("motion and forces", lambda: motion().forces(), note="`linkage.circuit(..).forces()`"),
        Work("forces alone", lambda: circuit.forces(), note="of a circuit that is known"),
    ]
    rows = [row(timing) for timing in compare(works, rounds=setting.choose(21, 3))]
    motion_alone = rows[0][1]
    assert isinstance(motion_alone, float)
    for steps in setting.choose(STEPS, STEPS[:1]):
        try:
            setting.peers.module("exudyn")
        except AbsentError as error:
            rows.append(["Exudyn", *[None] * 5, str(error)])
            break
        rows.append(theirs(linkage, steps, setting.choose(5, 1), motion_alone, peak))
    columns = ["", "ms a turn", "from", "to", "ratio", "torque off", "note"]
    return Outcome(TITLE, ABOUT, [Table("Sevenbar and Exudyn", columns, rows)])


def loaded() -> sb.Linkage:
    """The linkage with a ball on each moving link."""
    linkage = sb.load("seven_r")
    body = Body(MASS, (0.0, 0.0, 0.0), MASS * (1e-3 * GYRATION) ** 2 * np.eye(3))
    return linkage.loaded(
        bodies=dict.fromkeys(range(1, len(linkage.joints)), body), gravity=(0.0, 0.0, -9.80665)
    )


def row(timing: Timing) -> list[Cell]:
    """A work's row: of Sevenbar's own torque nothing is off."""
    times: list[Cell] = [1e3 * value for value in (timing.median, timing.low, timing.high)]
    return [timing.who, *times, timing.ratio, None, timing.failure or timing.note]


def theirs(linkage: sb.Linkage, steps: int, rounds: int, motion_alone: float, peak: float) -> list[Cell]:
    """Exudyn's row: the engine's run alone, and how far its torque is from Sevenbar's."""
    from sevenbar.simulation import exudyn_engine
    from sevenbar.simulation.agreement import agreement
    from sevenbar.simulation.run import prepared

    way, model = prepared(linkage, steps=steps)
    # of the steps ahead of the turn nothing is counted
    share = (len(way.rows) - 1) / way.steps
    times = []
    try:
        for _ in range(rounds):
            start = time.process_time()
            record = exudyn_engine.run(model, way.steps, way.step)
            times.append(1e3 * share * (time.process_time() - start))
    except Exception as error:
        return [f"Exudyn, {steps} steps", *[None] * 5, reason_of(error)]
    torque = agreement(way, model, record).difference(f"{linkage.drive.joint} torque")
    middle, low, high = spread(times)
    off = torque.greatest / peak if math.isfinite(torque.greatest) else None
    return [
        f"Exudyn, {steps:,} steps",
        middle,
        low,
        high,
        middle / motion_alone,
        off,
        "its lead is not counted",
    ]
