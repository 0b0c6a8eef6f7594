"""`python -m evidence.fuzz.calls`: public names and methods of results called with garbage, by introspection.

In each call one or two arguments are wrong, or all. Right are a result, an error of
`sevenbar.errors`, and the TypeError of a call that has not the function's parameters. Anything else is a
finding: an error from inside, a panic of the core, a call that does not end.
"""

from __future__ import annotations

import argparse
import inspect
import random
import signal
import sys
import tempfile
import time
import traceback
import types
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, chdir
from dataclasses import dataclass, field
from decimal import Decimal
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import sevenbar as sb
from sevenbar.errors import SevenbarError

#: Time [s] after which a call counts as one that does not end.
LONGEST = 20.0

#: Letters of the longest message: one that lists all that is wrong has some dozen lines.
LONGEST_MESSAGE = 6_000

#: Values that fit parameters of these names, so that a call gets beyond its first check.
FITS: Mapping[str, Any] = {
    "M": 700,
    "N": 700,
    "L1": 250,
    "L2": 997.5,
    "L3": 550,
    "D": 90,
    "a": 100,
    "b": 100,
    "alpha": "40 deg",
    "beta": "60 deg",
    "gamma": "50 deg",
    "angle": "30 deg",
    "hinge": 50,
    "ball": 90,
    "crank": 40,
    "rod": 140,
    "coupler": 120,
    "rocker": 80,
    "ground": 100,
    "reach": 100,
    "link": 2,
    "links": (2, 3),
    "at": (1, 2, 3),
    "theta": 0.3,
    "samples": 36,
    "input": "crank",
    "output": "rocker",
    "joint": "crank",
    "name": "P",
    "values": 0.3,
    "column": 0,
    "branch": 0,
    "duration": 1.0,
    "source": "rssr",
    "content": "format = 1",
    "length": (100, 100, 100),
    "twist": (1, 1, 1),
    "offset": (0, 0, 0),
    "mass": 1.0,
    "kind": "R",
    "code": "en",
    "pose": (0.3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    "key": "input",
    "radius": 1.0,
    "centre": (0, 0, 0),
    "origin": (0, 0, 0),
    "normal": (0, 0, 1),
    "x": (1, 0, 0),
    "y": (0, 1, 0),
    "path": "none.csv",
    "t": (0, 1, 2),
    "q": (0, 1, 2),
    "dq": (1, 1, 1),
    "ddq": (0, 0, 0),
    "dddq": (0, 0, 0),
    "speed": 1.0,
    "joints": [
        {"name": "crank", "kind": "R", "at": (0, 0, 0), "axis": (0, 0, 1)},
        {"kind": "R", "at": (40, 0, 0), "axis": (0, 0, 1)},
        {"kind": "R", "at": (180, 0, 0), "axis": (0, 0, 1)},
        {"name": "slider", "kind": "P", "at": (180, 0, 0), "axis": (1, 0, 0)},
    ],
}


def _deep() -> list[Any]:
    found: list[Any] = []
    for _ in range(100_000):
        found = [found]
    return found


def _own() -> list[Any]:
    found: list[Any] = []
    found.append(found)
    return found


class _Angry:
    """It has no attribute, and a length."""

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(name)

    def __len__(self) -> int:
        return 3


#: What no parameter, or hardly one, is meant to take; made anew for each call.
GARBAGE: Mapping[str, Callable[[], Any]] = {
    "None": lambda: None,
    "True": lambda: True,
    "-1": lambda: -1,
    "0": lambda: 0,
    "7": lambda: 7,
    "2**70": lambda: 2**70,
    "10**5000": lambda: 10**5000,
    "1e308": lambda: 1e308,
    "5e-324": lambda: 5e-324,
    "nan": lambda: float("nan"),
    "inf": lambda: float("inf"),
    "complex": lambda: 1j,
    "Decimal": lambda: Decimal("0.1"),
    "Decimal nan": lambda: Decimal("sNaN"),
    "Fraction": lambda: Fraction(1, 3),
    "np.int8": lambda: np.int8(3),
    "np.float32": lambda: np.float32(0.1),
    "np.str_": lambda: np.str_("crank"),
    "np.nan": lambda: np.float64("nan"),
    "empty text": lambda: "",
    "text": lambda: "no such thing",
    "crank": lambda: "crank",
    "deg": lambda: "30 deg",
    "long text": lambda: "x" * 100_000,
    "control": lambda: "a\x00\x1b\nb",
    "bidi": lambda: "\u202eabc",
    "surrogate": lambda: "\ud800",
    "code": lambda: "__import__('os').getcwd()",
    "bytes": lambda: b"crank",
    "[]": list,
    "()": lambda: (),
    "{}": dict,
    "set": lambda: {1, 2},
    "[[]]": lambda: [[]],
    "[1, 2]": lambda: [1, 2],
    "(1, 2, 3)": lambda: (1, 2, 3),
    "[nan, 0, 0]": lambda: [float("nan"), 0, 0],
    "ragged": lambda: [[1], [1, 2]],
    "[None]": lambda: [None],
    "['a', 1]": lambda: ["a", 1],
    "deep": _deep,
    "own": _own,
    "{'a': 1}": lambda: {"a": 1},
    "{1: 2}": lambda: {1: 2},
    "[{}]": lambda: [{}],
    "{None: None}": lambda: {None: None},
    "zeros(3)": lambda: np.zeros(3),
    "zeros(0)": lambda: np.zeros(0),
    "zeros(3, 3)": lambda: np.zeros((3, 3)),
    "zeros(10, 10, 2)": lambda: np.zeros((10, 10, 2)),
    "array of text": lambda: np.array(["crank", "rocker"]),
    "array of objects": lambda: np.array([None, {}]),
    "array()": lambda: np.array(1.5),
    "complex array": lambda: np.array([1j]),
    "times": lambda: np.array(["2026"], "M8"),
    "recarray": lambda: np.zeros(2, dtype=[("a", float)]),
    "object": object,
    "type": lambda: int,
    "function": lambda: len,
    "lambda": lambda: lambda *_, **__: None,
    "generator": lambda: iter([1, 2, 3]),
    "range": lambda: range(3),
    "module": lambda: np,
    "Path": lambda: Path("none"),
    "slice": lambda: slice(1),
    "Ellipsis": lambda: ...,
    "NotImplemented": lambda: NotImplemented,
    "error": lambda: ValueError("x"),
    "Angry": _Angry,
    "linkage": lambda: sb.load("planar_4r"),
    "point": lambda: sb.Point("P", 1, (0.0, 0.0, 0.0)),
}


@dataclass(frozen=True)
class Target:
    """Something that is called: its name, and its parameters."""

    name: str
    call: Callable[..., Any]
    parameters: tuple[inspect.Parameter, ...]


@dataclass
class Found:
    """What came of the calls: how many ended how, and one example of each fault."""

    ends: Counter[str] = field(default_factory=Counter)
    faults: dict[str, str] = field(default_factory=dict)
    slowest: tuple[float, str] = (0.0, "")

    @property
    def calls(self) -> int:
        """How many calls there were."""
        return self.ends.total()


def targets() -> list[Target]:
    """The callables of `sevenbar.__all__`, and the public methods of what they and their methods give."""
    found = [
        _target(name, getattr(sb, name))
        for name in sb.__all__
        if callable(getattr(sb, name)) and name != "errors"
    ]
    for thing in results():
        for name, method in _methods(thing):
            found.append(_target(f"{type(thing).__name__}.{name}", method))
    return found


def results() -> Iterator[Any]:
    """One of each kind of result."""
    rssr, planar, spatial = sb.load("rssr"), sb.load("planar_4r"), sb.load("bennett")
    loaded = planar.loaded(
        bodies={2: sb.Body(1.0, (10.0, 0.0, 0.0)), 3: sb.Body(2.0, (5.0, 5.0, 0.0))},
        gravity=(0, -9.81, 0),
        loads=[sb.Load(3, torque=(0.0, 0.0, 1.0))],
    )
    yield from (rssr, spatial, loaded, sb.Body(1.0, (0.0, 0.0, 0.0)), sb.Point("P", 1, (0.0, 0.0, 0.0)))
    for linkage in (rssr, loaded):
        motion = linkage.motion(36)
        circuit = motion.circuits[0]
        yield from (motion, circuit, linkage.assembly_modes(0.3), rssr.output(0.3), linkage.mobility())
        yield from (circuit.point(2, (1.0, 2.0, 3.0)), circuit.screw_axes(2), circuit.link_motion(2))
        yield circuit.sensitivity()
    yield from (circuit.forces(), circuit.instant_centres(), linkage.as_four_bar(), linkage.plane)
    yield from (circuit.free_motion(0.2, samples=11), linkage.loading, motion.search)


def _methods(thing: Any) -> Iterator[tuple[str, Callable[..., Any]]]:
    """The public methods of a result, and its attributes as calls without arguments."""
    for name in dir(type(thing)):
        if name.startswith("_") and name not in ("__getitem__", "__contains__", "__eq__"):
            continue
        static = inspect.getattr_static(type(thing), name)
        if isinstance(static, types.FunctionType | staticmethod | classmethod):
            # plots are files of their own kind, and take a second each
            if name != "plot":
                yield name, getattr(thing, name)
        elif name.startswith("_"):
            continue
        else:
            yield name, partial(getattr, thing, name)


def _target(name: str, call: Callable[..., Any]) -> Target:
    kept = (
        []
        if isinstance(call, partial)
        else [
            one
            for one in inspect.signature(call).parameters.values()
            # a word for messages is not the caller's
            if one.kind not in (one.VAR_POSITIONAL, one.VAR_KEYWORD) and one.name != "key"
        ]
    )
    return Target(name, call, tuple(kept))


def drawn(target: Target, chance: random.Random) -> dict[str, str]:
    """Which parameters take garbage, and which; the others fit or are left out."""
    if not target.parameters:
        return {}
    most = len(target.parameters)
    count = chance.choice([1, 1, 1, 1, 2, 2, most])
    chosen = chance.sample(target.parameters, min(count, most))
    return {one.name: chance.choice(list(GARBAGE)) for one in chosen}


def called(target: Target, wrong: Mapping[str, str]) -> Any:
    """What the call gives, with garbage in some places."""
    given: list[Any] = []
    named: dict[str, Any] = {}
    for one in target.parameters:
        if one.name in wrong:
            value = GARBAGE[wrong[one.name]]()
        elif one.default is inspect.Parameter.empty:
            value = FITS.get(one.name, 1.0)
        else:
            continue
        if one.kind is one.POSITIONAL_ONLY:
            given.append(value)
        else:
            named[one.name] = value
    found = target.call(*given, **named)
    if isinstance(found, AbstractContextManager):
        with found:
            return None
    if isinstance(found, types.GeneratorType):
        return next(found, None)
    return found


def fault(error: BaseException, target: Target) -> str:
    """What is wrong with the error of a call; "" for one that is meant."""
    if isinstance(error, SevenbarError):
        text = str(error)
        if len(text) > LONGEST_MESSAGE or not text:
            return f"{target.name}: a message of {len(text)} letters"
        return ""
    frames = traceback.extract_tb(error.__traceback__)
    inside = [frame for frame in frames if Path(frame.filename) != Path(__file__)]
    kind = type(error).__name__
    if not inside and isinstance(error, TypeError | AttributeError):
        return ""  # the call's own: a parameter that is missing or twice
    last = inside[-1] if inside else frames[-1]
    place = f"{Path(last.filename).name}:{last.lineno}"
    # indexing says so in Python's own words
    if target.name.endswith("__getitem__") and isinstance(error, IndexError | KeyError | TypeError):
        return ""
    return f"{place}: {kind}"


class _Endless(BaseException):
    """A call that does not end."""


def _give_up(*_: object) -> None:
    raise _Endless


def run(calls: int, seed: int) -> Found:
    """So many calls, each target as often as another."""
    chance, found = random.Random(seed), Found()
    every = targets()
    signal.signal(signal.SIGALRM, _give_up)
    with tempfile.TemporaryDirectory() as folder, chdir(folder), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for number in range(calls):
            target = every[number % len(every)]
            _judge(target, drawn(target, chance), found)
    return found


def _judge(target: Target, wrong: Mapping[str, str], found: Found) -> None:
    words = f"{target.name}({', '.join(f'{key}={value}' for key, value in wrong.items())})"
    begin = time.perf_counter()
    signal.setitimer(signal.ITIMER_REAL, LONGEST)
    try:
        called(target, wrong)
        end = "result"
    except _Endless:
        end = "endless"
        found.faults.setdefault(f"{target.name}: does not end in {LONGEST:g} s", words)
    except (KeyboardInterrupt, SystemExit):
        raise
    except BaseException as error:
        flaw = fault(error, target)
        end = "error from inside" if flaw else "refused"
        if flaw:
            found.faults.setdefault(flaw, f"{words}: {str(error)[:100]}")
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
    found.ends[end] += 1
    found.slowest = max(found.slowest, (time.perf_counter() - begin, words))


def main() -> int:
    """Prints how the calls ended and each fault once; 1 where there is one."""
    parser = argparse.ArgumentParser(prog="python -m evidence.fuzz.calls", description=__doc__)
    parser.add_argument("--calls", type=int, default=50_000)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    found = run(given.calls, given.seed)
    for flaw, words in sorted(found.faults.items()):
        print(f"{flaw}\n    {words}")
    print(f"{found.calls} calls of {len(targets())} names: {dict(found.ends)}")
    print(f"slowest {found.slowest[0]:.2f} s: {found.slowest[1]}")
    return 1 if found.faults else 0


if __name__ == "__main__":
    sys.exit(main())
