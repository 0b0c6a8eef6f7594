"""The page docs/accuracy.md, from the results alone; it says nothing that only today's numbers bear out."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator, Mapping
from typing import Any

from evidence.accuracy.quantiles import QUANTITIES, SHARES
from evidence.circumstances import in_words
from evidence.markdown import table

Results = Mapping[str, Any]

#: Characters of a line of prose.
WIDTH = 160

#: Relative errors of velocity, acceleration and jerk that the RSSR and general loops are to keep.
ASKED = {"closed form": (1e-12, 1e-11, 1e-10), "general": (1e-10, 1e-9, 1e-8)}


def number(value: float) -> str:
    """Two digits, as a power of ten where it is small."""
    return "0" if value == 0 else f"{value:.1e}" if value < 0.01 or value >= 1000 else f"{value:.2g}"


def text(results: Results) -> str:
    """The whole page."""
    parts = [*_head(results)]
    sections = (
        ("rows", _rows),
        ("dead_centres", _dead_centres),
        ("extremes", _extremes),
        ("closed_forms", _closed_forms),
        ("exudyn", _simulators),
        ("published", _published),
        ("differences", _differences),
    )
    for key, section in sections:
        if results.get(key):
            parts += section(results)
    return "\n\n".join(_wrapped(part) for part in parts) + "\n"


def _wrapped(part: str) -> str:
    """Prose in lines of `WIDTH`; tables, headings, figures and formulas as they are."""
    if part.startswith(("|", "#", "![", "    ")):
        return part
    return textwrap.fill(part, WIDTH, break_long_words=False, break_on_hyphens=False)


def _head(results: Results) -> Iterator[str]:
    made, settings = results["made"], results["settings"]
    yield "# Accuracy"
    yield (
        "How far Sevenbar's numbers are from the truth, for every loop of `sevenbar gallery`: beside "
        "references of forty digits and more, the closed forms of textbooks, two simulators, and printed "
        "numbers. `make accuracy` measures all of it and writes this page, its figures and "
        "`evidence/accuracy/results.json`; no number here was typed by hand."
    )
    if not settings["whole"]:
        yield "**A part only:** of fewer linkages or rows than `make accuracy` takes."
    yield (
        f"Made {in_words(made)}; {settings['seconds']} s of processor time. Rows and points are drawn at "
        f"random from the seed {settings['seed']}."
    )
    yield "![Differences of velocities from each reference](images/accuracy_references.svg)"


def _rows(results: Results) -> Iterator[str]:
    rows, settings = results["rows"], results["settings"]
    yield "## Against forty digits"
    yield (
        "**The references** (`evidence/accuracy/precise_loops.py`, `evidence/accuracy/reference_rssr.py`) "
        "know the description of a linkage and nothing else: the loop closes, or two balls keep their "
        "distance. Poses are found by Newton's method in 60 and 80 digits, derivatives from differences with "
        "steps of 1e-14 and 1e-20, of which 18 digits and more are left. No formula is shared with the core. "
        f"On every circuit, {settings['random']} inputs at random in a full turn (those that the circuit "
        f"reaches), and the {settings['worst']} worst conditioned of {settings['grid']} inputs a turn. "
        "Each row compares all joints, and a point of a moving link drawn at random, within half a size "
        "of its frame. Left out: what only a convention holds (an idle spin), the turns of a ball within "
        f"12 degrees of where they have no direction, and rows nearer than {settings['near']} rad to an "
        "input dead centre, which are [below](#towards-dead-centres)."
    )
    yield (
        "**Scales.** Positions: radians; slides and places in parts of the longest link. A rate of order "
        "k: in parts of the greatest component of the exact vector in *the same row*, or of the input's "
        "speed to the power k where that is more (beside an output dead centre a velocity passes zero and "
        "has no relative error). *In roundings*: the error over 2^-53 times the row's `condition`, so 1 "
        "is what one rounding of the closure may come to."
    )
    yield "![Median to greatest error of joints and points](images/accuracy_quantiles.svg)"
    yield "Rows compared, and the greatest error of all of them, random and worst conditioned:"
    greatest = []
    for name, found in rows.items():
        cells = [
            name,
            found["kind"],
            str(found["circuits"]),
            str(_count(found)),
            str(found["digits"]),
        ]
        for what in ("joints", "points"):
            cells += [
                number(max(found[chosen][what][q]["errors"]["greatest"] for chosen in ("random", "worst")))
                for q in QUANTITIES
            ]
        greatest.append(cells)
    short = ("pos.", "vel.", "acc.", "jerk")
    yield table(
        ["linkage", "joints", "circuits", "rows", "digits", *short, *(f"point {word}" for word in short)],
        greatest,
    )
    yield _verdict(rows)
    for order, quantity in enumerate(QUANTITIES):
        yield f"### {quantity.capitalize()}"
        yield (
            f"{'In its scale' if order == 0 else 'In parts of its scale'}, then in roundings; rows at "
            "random. *Worst*: the greatest over the worst conditioned rows."
        )
        for measure, word in (("errors", "error"), ("roundings", "roundings")):
            yield table(
                [
                    f"{word} of",
                    *(f"joints {share}" for share in SHARES),
                    "worst",
                    *(f"point {share}" for share in SHARES),
                    "worst",
                ],
                [
                    [
                        name,
                        *(
                            cell
                            for what in ("joints", "points")
                            for cell in (
                                *(number(found["random"][what][quantity][measure][s]) for s in SHARES),
                                number(found["worst"][what][quantity][measure]["greatest"]),
                            )
                        ),
                    ]
                    for name, found in rows.items()
                ],
            )
    yield "### Where it was worst"
    yield (
        "The row of the greatest error of the joints' jerk of each linkage, so that anybody can look at "
        "it (`motion(law=..)` with this input):"
    )
    worst = []
    for name, found in rows.items():
        row = max(
            (found[chosen]["joints"]["jerk"]["worst"] for chosen in ("random", "worst")),
            key=lambda one: float(one["error"]),
        )
        worst.append(
            [name, str(row["circuit"]), repr(row["input"]), number(row["condition"]), number(row["error"])]
        )
    yield table(["linkage", "circuit", "input", "condition", "error"], worst)


def _count(found: Mapping[str, Any]) -> int:
    return sum(int(found[chosen]["joints"]["position"]["rows"]) for chosen in ("random", "worst"))


def _verdict(rows: Mapping[str, Any]) -> str:
    """Whether what is required is kept, and by whom not."""
    missed = []
    for name, found in rows.items():
        asked = ASKED["closed form" if name == "rssr" else "general"]
        for order, quantity in enumerate(QUANTITIES[1:]):
            for what in ("joints", "points"):
                error = max(found[c][what][quantity]["errors"]["greatest"] for c in ("random", "worst"))
                if error > asked[order]:
                    missed.append(f"{name} ({quantity} of {what}: {number(error)})")
    said = (
        "Asked for are 1e-12, 1e-11 and 1e-10 of velocity, acceleration and jerk for the RSSR in closed "
        "form, 1e-10, 1e-9 and 1e-8 for general loops. "
    )
    total = sum(_count(found) for found in rows.values())
    if missed:
        return f"{said}**Missed** by {'; '.join(missed)}; kept in all else of the {total:,} rows."
    return f"{said}Kept in every one of the {total:,} rows."


def _dead_centres(results: Results) -> Iterator[str]:
    found, (far, near) = results["dead_centres"], results["settings"]["distances"]
    yield "## Towards dead centres"
    yield (
        "At an input dead centre the input stands still, and the rates of all other joints grow without "
        "bound: order k goes with the distance to the power 1/2 - k. One rounding of the closure moves "
        "the dead centre by about eps, and with it such a rate by"
    )
    yield "    relative change of order k  ~  (k - 1/2) eps / distance,"
    yield (
        "whatever the method that computes it in double precision. The `condition` "
        "of a row tells that distance: the RSSR's closed form has condition ~ 1 / "
        "distance, a general loop condition ~ 1 / distance^(1/2). The *bound* below is therefore eps x "
        "condition for the former, eps x condition^2 for the latter, with eps = 2^-53. Every linkage is "
        "driven by its input and by its output (so that crank-rockers have dead centres), at distances "
        f"from {number(far)} down to {number(near)}, on both passes. From a condition of 1e13 (closed "
        "form) on, rates are NaN with the status `dead-centre`."
    )
    yield "![Errors over the distance of the dead centre](images/accuracy_dead_centres.svg)"
    rows = []
    for name, of_one in found.items():
        for driven in of_one["driven"]:
            steps = driven["steps"]
            nearest = min(steps, key=lambda step: float(step["apart"]))
            rows.append(
                [
                    f"{name}, {driven['input']}",
                    str(driven["rows"]),
                    number(nearest["condition"]),
                    *(number(error) for error in nearest["errors"]),
                    *(number(max(step["bounds"][order] for step in steps)) for order in range(1, 4)),
                ]
            )
    if rows:
        yield "The joints at the nearest distance, and the greatest part of the bound over all distances:"
        yield table(
            [
                "linkage, driven by",
                "rows",
                "condition",
                *(f"{q} error" for q in QUANTITIES),
                *(f"{q} / bound" for q in QUANTITIES[1:]),
            ],
            rows,
        )
    still = [name for name, of_one in found.items() if not of_one["driven"]]
    if still:
        yield f"No input dead centre either way: {', '.join(still)}."
    yield "### Where dead centres are"
    yield (
        "A dead centre beside the zero of the derivative of the standing joint's value by the other's, "
        "found by Newton's method in 60 digits. The standing joint's value is at an extreme, so it is far "
        "better known than the moving one's. Asked for: 1e-12 (RSSR) and 1e-10 (general), in parts of 1 "
        "or of the dead centre's own condition where that is more."
    )
    places = []
    for name, of_one in found.items():
        for told in of_one["places"]:
            places.append(
                [
                    f"{name}, {told['input']}",
                    str(told["count"]),
                    str(told["left out"]),
                    number(told["condition"]),
                    number(told["still"]),
                    number(told["moving"]),
                    number(told["part"]),
                    "yes" if not told["beyond"] else f"{told['beyond']} not",
                ]
            )
    if places:
        yield table(
            [
                "linkage, driven by",
                "dead centres",
                "left out",
                "condition",
                "standing joint",
                "moving joint",
                "part of condition",
                "kept",
            ],
            places,
        )


def _extremes(results: Results) -> Iterator[str]:
    yield "## Extremes"
    yield (
        "The lowest and highest velocity, acceleration and jerk of the output along each circuit, beside "
        "the vertex of the exact rate in 60 digits. Values in parts of the greater of both ends, or of "
        "the input's pace where that is more; *place*: how far the input of the extreme is off [rad], "
        "which a flat extreme leaves open. Asked for in a value: 1e-10."
    )
    yield table(
        ["linkage", "extremes", *QUANTITIES[1:], "place", "kept"],
        [
            [
                name,
                str(found["count"]),
                *(number(found["value"][quantity]) for quantity in QUANTITIES[1:]),
                number(found["place"]),
                "yes" if not found["beyond"] else f"{found['beyond']} not",
            ]
            for name, found in results["extremes"].items()
            if found["count"]
        ],
    )
    bare = [name for name, found in results["extremes"].items() if not found["count"]]
    if bare:
        yield f"Without any, since rates grow without bound on all circuits: {', '.join(bare)}."


def _closed_forms(results: Results) -> Iterator[str]:
    yield "## Closed forms of the textbooks"
    yield (
        "The output by formulas that others have printed, in forty digits, from the dimensions as the "
        "files print them; derivatives by exact differentiation (series in time, "
        "`evidence/accuracy/series.py`). "
        f"Greatest error over {results['settings']['inputs']} inputs at random on every circuit, scales as "
        "above; in brackets, in roundings."
    )
    yield table(
        ["linkage", "formula", "source", "rows", *QUANTITIES],
        [
            [
                name,
                f"`{found['formula']}`",
                found["source"],
                str(found["output"]["position"]["rows"]),
                *(
                    f"{number(found['output'][q]['errors']['greatest'])} "
                    f"({number(found['output'][q]['roundings']['greatest'])})"
                    for q in QUANTITIES
                ),
            ]
            for name, found in results["closed_forms"].items()
        ],
    )


def _simulators(results: Results) -> Iterator[str]:
    yield "## Simulators"
    yield (
        "[Rigid bodies and joints](simulation.md) moved by programs that know nothing of Sevenbar's "
        f"equations, first circuit, {results['settings']['steps']:,} steps a turn. What differs is theirs: "
        "Exudyn's velocities and accelerations are of second order in the step, MuJoCo's loop is soft. So "
        "this bounds gross mistakes, not roundings. The output: position in radians or parts of the size, "
        "rates in parts of the greatest, median / greatest."
    )
    for engine in ("exudyn", "mujoco"):
        runs = results.get(engine, {})
        if not runs:
            continue
        done = {name: run for name, run in runs.items() if "output" in run}
        for said in dict.fromkeys(run["missing"] for run in runs.values() if "missing" in run):
            names = ", ".join(name for name, run in runs.items() if run.get("missing") == said)
            yield f"Without {engine} of {names}: {said}."
        if not done:
            continue
        first = next(iter(done.values()))
        yield f"{first['engine']} {first['version']}:"
        yield table(
            ["linkage", "course", "rows", *QUANTITIES[:3], "gap / size"],
            [
                [
                    name,
                    run["course"],
                    str(run["rows"]),
                    *(
                        f"{number(run['output'][q]['median'])} / {number(run['output'][q]['greatest'])}"
                        for q in QUANTITIES[:3]
                    ),
                    number(run["gap"]),
                ]
                for name, run in done.items()
            ],
        )


def _published(results: Results) -> Iterator[str]:
    found = results["published"]["all"]
    yield "## Published numbers"
    yield (
        "**Table 1 of the RSSR paper**, its computed column. The difference is in units of the last digit "
        "printed; up to 0.5 the numbers agree."
    )
    yield table(
        ["quantity", "end", "printed", "Sevenbar", "difference [last digit]"],
        [
            [row["quantity"], row["end"], row["printed"], f"{row['ours']:.7g}", f"{row['digits']:.2f}"]
            for row in found["table_1"]
        ],
    )
    yield (
        "**Its formulas of the rates**, evaluated in double precision at random inputs, beside "
        "Sevenbar's, in parts of the greatest rate. With their [signs "
        "mended](rssr.md#what-the-paper-gets-wrong), and as printed:"
    )
    yield table(
        ["equation", "signs mended", "as printed"],
        [[row["equation"], number(row["mended"]), number(row["printed"])] for row in found["formulas"]],
    )
    seven = found["seven_r"]
    errors = seven["errors"]
    yield (
        "**The 7R paper's linkage.** The paper prints dimensions and pictures, no numbers to compare. "
        "Kept in `tests/references` are all modes at two inputs, with rates and the paper's point, worked "
        f"out elsewhere in 40 digits: {seven['compared']} of {seven['poses']} poses are met by rows of the "
        "circuits. Greatest errors (rates by the input's; the point's in parts of its greatest length):"
    )
    yield table(
        ["angles", "first rates", "second rates", "place", "velocity", "acceleration"],
        [[number(errors[name]) for name in ("theta", "dtheta", "ddtheta", "r4", "v4", "a4")]],
    )
    sixteen = found["sixteen"]
    yield (
        f"**Sixteen modes.** Liu and Zhu's arm, closed, has {sixteen['printed']} real modes, printed with "
        f"eight decimals of a degree. Found: {sixteen['found']}, of which {sixteen['met']} are printed "
        f"ones; the greatest difference of any angle is {number(sixteen['greatest_deg'])} degrees."
    )


def _differences(results: Results) -> Iterator[str]:
    found = results["differences"]["all"]
    by_step = found["by_step"]
    steps = by_step["steps"]
    yield "## The 7R paper's finite differences"
    yield (
        "The paper has velocities as steps from point to point over the time between them, accelerations "
        "as the same of the velocities, and closes the row with point n against point 1. For its point on "
        "link 4, first circuit, the greatest error over a turn in parts of the greatest rate; the paper "
        "does not say how many points it takes:"
    )
    yield table(
        ["samples", "velocity", "acceleration", "velocity at the middle", "acceleration at the middle"],
        [[f"{int(n):,}", *(_per_cent(e) for e in errors)] for n, errors in found["by_samples"].items()],
    )
    yield (
        "A difference is the rate in the *middle* of its step. Set against the step's beginning, as in "
        "the paper, it is wrong in proportion to the step; set against the middle (the last two columns), "
        "to its square. Where the samples hold both 0 and 360 degrees, as MATLAB's `linspace` makes them, "
        f"point n is point 1 and the last velocity is zero: an error of {_per_cent(found['last_sample'])} "
        "of the greatest speed."
    )
    yield "![Errors of forward and central differences over the step](images/accuracy_differences.svg)"
    yield (
        "With a smaller step the error falls until the rounding of the positions, over the step to the "
        "power of the order, takes over. At one degree and at the step that turns out best (nobody knows "
        "it beforehand), against 60 digits at random inputs:"
    )
    degree = min(range(len(steps)), key=lambda k: abs(math.log(steps[k] / math.radians(1.0))))
    rows = []
    for order, quantity in enumerate(QUANTITIES[1:]):
        cells = [quantity]
        for scheme in ("forward", "central"):
            errors = by_step[scheme][order]
            best = min(range(len(steps)), key=lambda k, errors=errors: errors[k])  # type: ignore[misc]
            cells += [number(errors[degree]), f"{number(errors[best])} at {number(steps[best])}"]
        rows.append([*cells, number(by_step["exact rates"][order])])
    yield table(
        [
            "rate",
            f"forward, {number(steps[degree])} rad",
            "forward, best",
            f"central, {number(steps[degree])} rad",
            "central, best",
            "exact rates",
        ],
        rows,
    )


def _per_cent(part: float) -> str:
    return f"{100 * part:.3g} %"
