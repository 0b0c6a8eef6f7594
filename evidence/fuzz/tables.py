"""Mutated text tables: measured values and input laws, read from a file as the commands read them."""

from __future__ import annotations

import random
import re
from collections import Counter
from pathlib import Path

import numpy as np

from evidence.fuzz.checks import hold
from evidence.fuzz.messages import family, look_at
from sevenbar.description.files import loads
from sevenbar.description.gallery import text
from sevenbar.description.law_file import load_law
from sevenbar.errors import SevenbarError
from sevenbar.measuring.measured import Ends, Measured, read_measured

#: Cells that programs and people leave.
CELLS = (
    "", "nan", "inf", "-", "#N/A", "1e308", "1e309", "-1e-320", "1,5", "1.5d3", "abc", "0", "1 mm", '"2"',
    "1e", "--1", "\u00bd", "\x00", "9" * 400, "1;2", "true",
)  # fmt: skip

HEADS = (
    "time [s],rocker [deg],rocker_velocity [rad/s]", "t;angle (rad)", "time_s,angle_deg", "time\trocker",
    "quantity,lowest,highest", "% time angle", "crank [deg],crank [rad/s]", "time [s],crank [rad]",
    '"time, s","rocker, deg"', "time [min],rocker [mm]", "1,2,3", "time [s],time [s],angle [deg]", "",
)  # fmt: skip

#: Cells, and what parts them.
_TOKEN = re.compile(r"[,;\t\n]|[^,;\t\n]+")

SEPARATORS = (",", ";", "\t", " ", ",,", "\n", "\r\n")


def drawn(seed: int, index: int) -> bytes:
    """The mutated table of a number."""
    rng = random.Random((seed << 40) + index)
    rows = [
        f"{0.1 * k:.3g},{60 * (0.1 * k) ** 2:.6g},{12 * k:.6g}" for k in range(rng.choice((0, 1, 2, 7, 20)))
    ]
    tokens = _TOKEN.findall("\n".join([rng.choice(HEADS), *rows]) + "\n")
    for _ in range(rng.randint(0, 4)):
        place = rng.randrange(len(tokens))
        match rng.randint(0, 5):
            case 0 | 1:
                tokens[place] = rng.choice(CELLS)
            case 2:
                tokens[place] = rng.choice(SEPARATORS)
            case 3:
                del tokens[place : place + rng.randint(1, 5)]
            case 4:
                tokens[place:place] = tokens[place : place + rng.randint(1, 9)]
            case _:
                tokens.insert(place, f"\n{rng.choice(HEADS)}\n")
        tokens = tokens or [""]
    content = "".join(tokens)
    match rng.randint(0, 11):
        case 0:
            return content.encode("utf-16")
        case 1:
            return content.replace(",", ";").replace(".", ",").encode()
        case 2:
            data = bytearray(content.encode() or b" ")
            data[rng.randrange(len(data))] = rng.randrange(256)
            return bytes(data)
    return content.encode()


def judge(content: bytes, index: int, seen: Counter[str], folder: Path) -> None:
    """Reads a table as measured values or as a law; as `files.judge` otherwise."""
    path = folder / "t.csv"
    path.write_bytes(content)
    try:
        if index % 2:
            found = read_measured(path, Ends("crank", "rocker"), skip_nan=bool(index % 4 == 1))
            if isinstance(found, Measured):
                numbers = np.concatenate([values.ravel() for values in found.values.values()])
                hold(len(found) >= 2, "measured values of fewer than two rows")
            else:
                numbers = np.array([x for pair in found.values.values() for x in pair])
            hold(np.isfinite(numbers).all(), "a measured value that is no number")
        else:
            law = load_law(path, loads(text("rssr")))
            hold(
                np.isfinite(law.table).all() and np.isfinite(law.t).all(),
                "a law with a value that is no number",
            )
            hold((np.diff(law.t) > 0).all(), "a law whose times do not rise")
    except SevenbarError as error:
        look_at(error, "")
        told = family(error, str(path))
        seen[f"refused {told}"] += 1
        return
    seen["loaded"] += 1
