"""The linkage as a virtual prototype: built and moved by another program, beside what Sevenbar says.

    run = simulate(sb.load("rssr"), "exudyn")
    print(run.difference("rocker angle").greatest)

The engine is given rigid bodies, joints and a drive, and the pose and velocities to start with; nothing else.
"""

from __future__ import annotations

from collections.abc import Callable

from sevenbar.errors import RequestError, shown
from sevenbar.export.prototype import Prototype, prototype
from sevenbar.kinematics.linkage import Linkage, sample_count
from sevenbar.simulation import exudyn_engine, mujoco_engine
from sevenbar.simulation.agreement import Simulation, agreement
from sevenbar.simulation.course import Course, course
from sevenbar.simulation.engine import Record, imported
from sevenbar.text.progress import Progress

#: The engines by name.
ENGINES: dict[str, Callable[..., Record]] = {"exudyn": exudyn_engine.run, "mujoco": mujoco_engine.run}

#: Steps for a turn of the input where none are given, as in the paper's simulation.
STEPS = 3600


def simulate(
    linkage: Linkage,
    engine: str,
    *,
    steps: int = STEPS,
    circuit: int = 0,
    input: str | None = None,
    output: str | None = None,
    speed: float | str | None = None,
    progress: Progress | None = None,
) -> Simulation:
    """Moves a linkage in an engine, "exudyn" or "mujoco", along one circuit, and compares.

    The input turns at constant speed (the drive's where none is given) in `steps` steps a turn, each one a
    row of Sevenbar's motion: until the circuit closes, or along one pass of an input with dead centres.
    Raises `RequestError` for what cannot be simulated, `MissingExtraError` where the engine is not installed
    and `EngineError` where the engine loses the motion.

        >>> import sevenbar as sb
        >>> found = simulate(sb.load("rssr"), "mujoco", steps=360)
        >>> found.difference("rocker angle").greatest < 1e-3
        True
    """
    ready(engine)
    way, model = prepared(linkage, steps=steps, circuit=circuit, input=input, output=output, speed=speed)
    return moved(way, model, engine, progress)


def prepared(
    linkage: Linkage,
    *,
    steps: int = STEPS,
    circuit: int = 0,
    input: str | None = None,
    output: str | None = None,
    speed: float | str | None = None,
) -> tuple[Course, Prototype]:
    """What an engine will be asked for, and the prototype it is given; raises as `simulate` does."""
    motion = linkage.motion(sample_count("steps", steps), input=input, output=output, speed=speed)
    way = course(motion, circuit)
    return way, prototype(linkage, way.circuit, way.start, motion.speed)


def ready(engine: str) -> None:
    """Nothing where the engine is known and installed; else `RequestError` or `MissingExtraError`."""
    if engine not in ENGINES:
        hint = ""
        if isinstance(engine, str) and engine.lower() in ("adams", "msc adams", "urdf", "simscape"):
            hint = "; a file for another program is written by 'sevenbar export .. --to', as in --to adams"
        raise RequestError(f"engine: {shown(engine)} is not an engine; give {' or '.join(ENGINES)}{hint}")
    imported(engine)


def moved(way: Course, model: Prototype, engine: str, progress: Progress | None = None) -> Simulation:
    """A prototype moved along a course by an engine."""
    record = ENGINES[engine](model, way.steps, way.step, progress=progress)
    return agreement(way, model, record)
