"""Sevenbar beside numbers that others printed or worked out: the two papers, and the kept references."""

from __future__ import annotations

import json
import math

import numpy as np

import sevenbar as sb
from evidence import ROOT
from evidence.accuracy.gallery_rows import seeded

REFERENCES = ROOT / "tests" / "references"

#: The point of the 7R paper: its link and place.
LINK, POINT = 4, (-100.0, -90.0, -80.0)

#: Rows nearer than this [rad] to a pose of the references are that pose.
SAME_POSE = 1e-9

#: Inputs at which the RSSR paper's formulas for the rates are evaluated.
INPUTS = 500


def _read(name: str) -> dict[str, object]:
    found: dict[str, object] = json.loads((REFERENCES / name).read_text(encoding="utf-8"))
    return found


def table_1() -> list[dict[str, object]]:
    """The computed column of the RSSR paper's Table 1: printed, ours, the difference in last digits."""
    text = (REFERENCES / "rssr_table1.json").read_text(encoding="utf-8")
    printed = json.loads(text, parse_float=str, parse_int=str)["computed"]
    # the paper's circuit is that of its eq. (8), branch 0
    circuit = sb.load("rssr").motion().circuits[0]
    rows = []
    for quantity, ends in printed.items():
        ours = getattr(circuit, quantity)
        for end, word, value in zip(("lowest", "highest"), ends, (ours.lowest, ours.highest), strict=True):
            digit = 10.0 ** -len(word.partition(".")[2])
            difference = abs(value - float(word)) / digit
            rows.append(
                {"quantity": quantity, "end": end, "printed": word, "ours": value, "digits": difference}
            )
    return rows


def formulas_of_rates() -> list[dict[str, object]]:
    """The paper's eq. (12) and (13), signs mended and as printed, beside the rates of its branch 0.

    `beta' = -+ alpha' L1 (M sin - D cos - L3 cos cos) / R`, `beta'' = -+ (alpha'^2 Q + beta'^2 S + 2 alpha'
    beta' T) / R`. Errors relative to the greatest rate over the inputs.
    """
    linkage = sb.load("rssr")
    M, N, L1, L3, D = (linkage.dimensions[name] for name in ("M", "N", "L1", "L3", "D"))
    speed = linkage.drive.speed
    alpha = seeded("rssr", 3).uniform(0, 2 * math.pi, INPUTS)
    ours = linkage.output(alpha, order=2)
    assert ours.velocity is not None
    assert ours.acceleration is not None
    beta, velocity = ours.position[0], ours.velocity[0]
    ca, sa, cb, sb_ = np.cos(alpha), np.sin(alpha), np.cos(beta), np.sin(beta)
    R = L3 * (L1 * sa * sb_ - D * sb_ - N * cb)
    first = speed * L1 * (M * sa - D * ca - L3 * ca * cb) / R
    Q = L1 * (M * ca + D * sa + L3 * sa * cb)
    S = L3 * (L1 * sa * cb - D * cb + N * sb_)
    T = L1 * L3 * ca * sb_
    second = (speed**2 * Q + velocity**2 * S + 2 * speed * velocity * T) / R
    as_printed = (speed**2 * Q + beta**2 * S + 2 * speed * velocity * T) / R
    rows = []
    for equation, mended, printed, exact in (
        ("(12)", -first, first, velocity),
        ("(13)", -second, as_printed, ours.acceleration[0]),
    ):
        scale = float(np.abs(exact).max())
        errors = [float(np.abs(values - exact).max()) / scale for values in (mended, printed)]
        rows.append({"equation": equation, "mended": errors[0], "printed": errors[1]})
    return rows


def seven_r() -> dict[str, object]:
    """Greatest errors at the poses of the 7R paper's linkage that were worked out elsewhere in 40 digits.

    Angles in radians, rates of angles as they are (the input's speed is 1), places and rates of the paper's
    point relative to their greatest length over all poses.
    """
    modes = _read("seven_r_modes.json")["modes"]
    assert isinstance(modes, list)
    scales = {name: max(float(np.linalg.norm(mode[name])) for mode in modes) for name in ("r4", "v4", "a4")}
    worst = dict.fromkeys(("theta", "dtheta", "ddtheta", "r4", "v4", "a4"), 0.0)
    compared = 0
    for circuit in sb.load("seven_r").motion():
        trace = circuit.point(LINK, POINT)
        for mode in modes:
            off = np.abs((circuit.q - np.array(mode["theta"]) + np.pi) % (2 * np.pi) - np.pi)
            row = int(off.max(axis=1).argmin())
            if off[row].max() > SAME_POSE:
                continue
            compared += 1
            errors = {"theta": float(off[row].max())}
            for name, values in (("dtheta", circuit.dq), ("ddtheta", circuit.ddq)):
                errors[name] = float(np.abs(values[row] - np.array(mode[name])).max())
            places = {"r4": trace.position, "v4": trace.velocity, "a4": trace.acceleration}
            for name, values in places.items():
                length = float(np.linalg.norm(values[row] - np.array(mode[name])))
                errors[name] = length / scales[name]
            worst = {name: max(value, errors[name]) for name, value in worst.items()}
    return {"poses": len(modes), "compared": compared, "errors": worst}


def sixteen_modes() -> dict[str, object]:
    """A loop of sixteen real modes, printed with eight decimals of a degree: how many are met, how nearly."""
    kept = _read("seven_r_sixteen_modes.json")
    loop, printed = kept["loop"], kept["modes_deg"]
    assert isinstance(loop, dict)
    linkage = sb.from_dh(
        "RRRRRRR", length=loop["length"], twist=np.radians(loop["twist_deg"]), offset=loop["offset"]
    )
    modes = linkage.assembly_modes(math.radians(loop["theta1_deg"]))
    off = np.degrees(modes.q)[:, None, :] - np.array(printed)[None, :, :]
    apart = np.abs((off + 180) % 360 - 180).max(axis=2)
    return {
        "printed": apart.shape[1],
        "found": len(modes),
        "met": len(set(apart.argmin(axis=0))),
        "greatest_deg": float(apart.min(axis=0).max()),
    }


def measured() -> dict[str, object]:
    """All of it."""
    return {
        "table_1": table_1(),
        "formulas": formulas_of_rates(),
        "seven_r": seven_r(),
        "sixteen": sixteen_modes(),
    }
