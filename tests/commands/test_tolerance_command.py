"""`sevenbar tolerance` as a person calls it, and its figures."""

import csv
import json
import math

import numpy as np
import pytest

import sevenbar as sb
from command_runs import mistake, sevenbar
from places import ROOT
from sevenbar.design.tolerance.figures import deviation_figure, shares_figure
from sevenbar.design.tolerance.linear import linear_estimate
from sevenbar.design.tolerance.samples import monte_carlo
from sevenbar.design.tolerance.sensitivities import sensitivities


def test_the_command_writes_what_it_tells(tmp_path):
    out = tmp_path / "out"
    words = ("tolerance", "rssr", "--tolerance", "*=ISO 2768-m", "--tolerance", "D=0.1", "--samples", 24)
    run = sevenbar(*words, "--count", 50, "--out", out, "--figures", "svg")
    assert run.returncode == 0, run.stderr
    assert sorted(path.name for path in out.iterdir()) == [
        *("deviation.csv", "deviation.svg", "dimensions.csv", "sensitivities.csv", "shares.svg"),
        "tolerance.json",
    ]
    told = json.loads((out / "tolerance.json").read_text(encoding="utf-8"))
    assert [d["name"] for d in told["dimensions"]][:2] == ["L2", "M"]
    assert told["monte_carlo"]["linear_estimate_holds"] is True
    with (out / "deviation.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 24
    greatest = max(float(row["worst_case_deg"]) for row in rows)
    assert greatest == pytest.approx(math.degrees(told["worst_case"]["linear"]))
    with (out / "sensitivities.csv").open(encoding="utf-8") as file:
        slopes = list(csv.DictReader(file))
    widths = {d["name"]: d["tolerance"] for d in told["dimensions"]}
    total = max(sum(abs(float(row[f"{n}_deg_per_mm"])) * w for n, w in widths.items()) for row in slopes)
    assert total == pytest.approx(greatest)
    assert "exists already" in mistake(*words, "--out", out)


def test_a_wanted_error_gives_tolerances():
    found = json.loads(sevenbar("tolerance", "rssr", "--wanted", "0.5deg", "--count", 0, "--json").stdout)
    assert found["worst_case"]["linear"] == pytest.approx(math.radians(0.5))
    assert "monte_carlo" not in found


def test_a_point_s_coordinate_can_be_told():
    run = sevenbar(
        "tolerance", "rsur", "--tolerance", "*=0.01", "--of", "B.z", "--count", 20, "--samples", 12
    )
    assert run.returncode == 0, run.stderr
    assert "B.z, circuit 0" in run.stdout


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["rssr"], "tolerance: none given; give one as in 'L1=0.5', 'twist_*=0.1deg' or '*=ISO 2768-m'"),
        (["rssr", "--tolerance", "L1"], "--tolerance: 'L1' is not a name and a half width; give one as in"),
        (["rssr", "--wanted", "0"], "--wanted: '0' is not an error; give one greater than 0, as in 0.5deg"),
        (
            ["rssr", "--wanted", "1", "--tolerance", "L1=1"],
            "--wanted: --tolerance is given too; give one of them",
        ),
        (
            ["rssr", "--tolerance", "L1=1", "--count", "-1"],
            "count: -1 is not a number of samples; give 2 to 1000000",
        ),
        (["bennett", "--tolerance", "*=0.1"], "would open this overconstrained loop"),
        (
            ["rssr", "--tolerance", "L1=1", "--circuit", "5"],
            "circuit: 5 is not a circuit of this motion; give 0 to 1",
        ),
    ],
)
def test_a_mistake_is_told(words, message):
    assert message in mistake("tolerance", *words, cwd=ROOT)


def test_many_dimensions_share_a_bar_and_passes_have_their_own_panels():
    found = sensitivities(sb.load("seven_r"), samples=24)
    figure = shares_figure(linear_estimate(found, {"*": 0.1}))
    labels = [label.get_text() for label in figure.axes[0].get_yticklabels()]
    assert len(labels) == 14
    assert labels[-1].endswith("others together")
    rocking = linear_estimate(sensitivities(sb.load("rssr"), input="rocker"), {"*": 0.5})
    assert len(deviation_figure(rocking, None).axes) == 2


def test_the_band_of_the_figure_holds_the_samples():
    found = sensitivities(sb.load("rssr"), samples=24)
    exact = monte_carlo(found, {"*": 0.1}, 100)
    (axes,) = deviation_figure(exact.linear, exact).axes
    names = [line.get_label() for line in axes.get_lines()]
    assert "Monte Carlo, 95 % between" in names
    assert (np.abs(exact.quantiles) <= 1.05 * exact.linear.worst).all()
