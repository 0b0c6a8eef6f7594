"""Which errors of the lengths would cause the differences in the RSSR paper's Table 1.

Run: `python examples/table_1.py`. With e the differences of the six extremes, measured less computed, and J
their exact derivatives by the lengths:

- equal tolerances: the half width t on every length at which the worst case sum |J| t, or the statistical sum
  sqrt(sum (J t)^2), is as large as a difference;
- one length alone: the change that brings |W (e - J change)| down most, and what is left of it;
- all together: the changes with the least norm that do so along the r strongest directions of W J.

W divides each difference by the measured range. The last two are solved on the exact extremes, by steps of
the fixed J. Source: Sun and Zhou, Table 1.
"""

import math
from pathlib import Path

import numpy as np

import sevenbar as sb
from sevenbar.design.tolerance import sensitivities
from sevenbar.design.tolerance.tolerances import CLASSES, general_tolerance
from sevenbar.measuring.compare import ends_of
from sevenbar.measuring.extremes import compare_extremes
from sevenbar.measuring.measured import read_measured

LINKAGE = sb.load("rssr")
NAMES = [dimension.name for dimension in sensitivities(LINKAGE, samples=8).dimensions]
ENDS = ends_of(LINKAGE)
MEASURED = read_measured(Path(__file__).parent / "rssr_table1.csv", ENDS)

#: Steps of the fixed J on the exact extremes, and the step [mm] that ends them.
MOST_STEPS, SETTLED = 40, 1e-6

#: Singular value in parts of the greatest that is rounding: the size of the linkage changes no angle.
NOTHING = 1e-9


def table(changes):
    """The six extremes of the linkage with changed lengths [mm]: names, computed, measured, ranges."""
    lengths = {n: LINKAGE.dimensions[n] + change for n, change in zip(NAMES, changes, strict=True)}
    extents = compare_extremes(sb.rssr(**lengths, speed=LINKAGE.drive.speed), MEASURED, ENDS).table
    names = [f"{extent.quantity} {end}" for extent in extents for end in ("lowest", "highest")]
    spans = [extent.measured[1] - extent.measured[0] for extent in extents for _ in range(2)]
    computed, measured = (
        np.array([value for extent in extents for value in getattr(extent, kind)])
        for kind in ("computed", "measured")
    )
    return names, computed, measured, np.array(spans)


def left(changes):
    """W (measured less computed) of the changed linkage; `None` where it has no such extremes."""
    try:
        _, computed, measured, spans = table(changes)
    except sb.errors.SevenbarError:
        return None
    return (measured - computed) / spans


def rms(residual):
    """The root mean square."""
    return math.sqrt(float(np.mean(residual**2)))


def slopes():
    """J (6, lengths) [the extreme's unit per mm]."""
    found = sensitivities(LINKAGE)
    measures = [found.measure(name.replace(" ", "_")) for name in table(np.zeros(len(NAMES)))[0]]
    return np.array([measure.slopes * measure.scale for measure in measures])


def best(weighted, kept, rank):
    """The changes (lengths,) of some lengths along `rank` directions that leave least, and what is left."""
    u, values, vt = np.linalg.svd(weighted[:, kept], full_matrices=False)
    back = (vt[:rank].T / values[:rank]) @ u[:, :rank].T
    changes = np.zeros(len(NAMES))
    found, least = changes, math.inf
    for _ in range(MOST_STEPS):
        residual = left(changes)
        if residual is None:
            break
        if rms(residual) < least:
            found, least = changes, rms(residual)
        step = back @ residual
        changes = changes.copy()
        changes[kept] += step
        if np.abs(step).max() < SETTLED:
            break
    return found, least


def iso_class(changes):
    """The finest class of ISO 2768 that allows all changes of lengths that it has tolerances for."""
    for letter in CLASSES:
        pairs = [(c, general_tolerance(abs(LINKAGE.dimensions[n]), letter)) for n, c in changes.items()]
        allowed = [abs(change) <= width for change, width in pairs if width is not None]
        if allowed and all(allowed):
            return letter
    return "none"


def explained():
    """Rows of the three tables: the differences, one length alone, all together."""
    names, computed, measured, spans = table(np.zeros(len(NAMES)))
    jacobian, errors = slopes(), measured - computed
    weighted = jacobian / spans[:, None]
    values = np.linalg.svd(weighted, compute_uv=False)
    widths = {
        letter: np.array([general_tolerance(abs(LINKAGE.dimensions[n]), letter) or 0.0 for n in NAMES])
        for letter in CLASSES
    }
    differences = [
        {
            "name": name,
            "error": error,
            "per cent": 100 * error / abs(value),
            "worst": abs(error) / np.abs(row).sum(),
            "3 sigma": abs(error) / np.linalg.norm(row),
            **{letter: 100 * np.abs(row) @ own / abs(error) for letter, own in widths.items()},
        }
        for name, error, value, row in zip(names, errors, computed, jacobian, strict=True)
    ]
    greatest = max(range(len(names)), key=lambda j: abs(differences[j]["per cent"]))
    alone = []
    for k, name in enumerate(NAMES):
        changes, least = best(weighted, [k], 1)
        needed = errors[greatest] / jacobian[greatest, k]
        alone.append((name, changes[k], least, iso_class({name: changes[k]}), needed))
    together = []
    for rank in range(1, int((values > NOTHING * values.max()).sum()) + 1):
        changes, least = best(weighted, list(range(len(NAMES))), rank)
        together.append((changes, least, iso_class(dict(zip(NAMES, changes, strict=True)))))
    return differences, sorted(alone, key=lambda row: row[2]), together


def main():
    """Prints the three tables."""
    differences, alone, together = explained()
    whole = rms(left(np.zeros(len(NAMES))))
    print(f"residual {100 * whole:.2f} % of the measured ranges, root mean square\n")
    print(f"{'value':20} {'error':>8} {'worst':>6} {'3 sigma':>7}", *(f"{letter:>4}" for letter in CLASSES))
    for row in differences:
        print(
            f"{row['name']:20} {row['per cent']:+6.2f} % {row['worst']:6.3g} {row['3 sigma']:7.3g}",
            *(f"{row[letter]:4.0f}" for letter in CLASSES),
        )
    greatest = max(differences, key=lambda row: abs(row["per cent"]))["name"]
    print(f"\none alone [mm]   change residual   class   for {greatest}")
    for name, change, least, letter, needed in alone:
        print(f"{name:14} {change:+8.2f}   {100 * least:.2f} %   {letter:>5}   {needed:+8.2f}")
    print("\ntogether [mm]", *(f"{name:>7}" for name in NAMES), "residual   class")
    for rank, (changes, least, letter) in enumerate(together, 1):
        print(
            f"{rank:<13}", *(f"{change:+7.2f}" for change in changes), f"  {100 * least:.2f} %   {letter:>5}"
        )


if __name__ == "__main__":
    main()
