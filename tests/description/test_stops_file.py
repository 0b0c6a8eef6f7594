"""Stops and rods in linkage files: three forms, drafts, messages; in reports, tables and the studio's curves."""

import csv
import json
import math

import numpy as np
import pytest

import sevenbar as sb
from command_runs import sevenbar
from sevenbar import gallery
from sevenbar.description.draft import Draft
from sevenbar.drawing.quantities import quantities
from sevenbar.errors import DescriptionError
from sevenbar.reporting.report import as_dict, markdown
from sevenbar.studio.state.view import View
from sevenbar.studio.svg.curves import panels

RSSR = "format = 1\n[rssr]\nM = 700\nN = 700\nL1 = 250\nL3 = 550\nD = 0\n"

STOPS = """
[[stop]]
joint = "rocker"
range = [-10, "pi/6"]
[[stop]]
joint = "ball_a"
cone = "60 deg"
seat = [0, 0, -1]
[[rod]]
link = 1
radius = "1 cm"
[[rod]]
link = 3
radius = 20
"""


def test_a_file_has_its_stops_in_radians_and_the_length_unit():
    stops = sb.loads(RSSR + STOPS).stops
    assert stops.ranges == {"rocker": pytest.approx((math.radians(-10), math.radians(30)))}
    assert stops.cones["ball_a"].angle == pytest.approx(math.radians(60))
    assert stops.cones["ball_a"].seat == (0.0, 0.0, -1.0)
    assert stops.radii == {1: 10.0, 3: 20.0}


def test_rows_and_drawings_take_them_too_and_a_slide_has_a_range_of_lengths():
    rows = (
        gallery.text("seven_r")
        + '\n[[stop]]\njoint = "theta_4"\nrange = [330, 420]\n[[rod]]\nlink = 7\nradius = 3\n'
    )
    linkage = sb.loads(rows)
    assert linkage.stops.ranges["theta_4"] == pytest.approx((math.radians(330), math.radians(420)))
    assert linkage.stops.radii == {7: 3.0}
    drawn = sb.loads(gallery.text("rssp") + '\n[[stop]]\njoint = "slider"\nrange = ["-1 cm", 25]\n')
    assert drawn.stops.ranges == {"slider": (-10.0, 25.0)}


def test_a_draft_keeps_them_through_changes_and_toml():
    draft = Draft.of(RSSR + STOPS, "mine.toml")
    changed = draft.with_values({"L1": 240.0})
    assert changed.linkage.stops == draft.linkage.stops
    assert sb.loads(changed.toml()).stops == draft.linkage.stops
    given = sb.load("rssr").stopped(cones={"ball_b": "20 deg"}, ranges={"rocker": ("-10 deg", "30 deg")})
    again = sb.loads(Draft.of_linkage(given).toml())
    assert again.stops.cones["ball_b"].angle == pytest.approx(math.radians(20))
    assert again.description["stop"] == given.description["stop"]


@pytest.mark.parametrize(
    ("tables", "message"),
    [
        (
            '[[stop]]\njoint = "ball_a"\nrange = [0, 1]',
            "stop[1].range: joint 'ball_a' is a ball; give it a cone",
        ),
        ('[[stop]]\njoint = "crank"\ncone = 15', "stop[1].cone: is of joints S and U, which 'crank' is not"),
        (
            '[[stop]]\njoint = "crank"',
            "stop[1]: says nothing; give a range, a cone of S or U, or leave it out",
        ),
        ('[[stop]]\njoint = "crnk"\nrange = [0, 9]', "stop[1].joint: no joint 'crnk'; did you mean 'crank'?"),
        (
            '[[stop]]\njoint = "crank"\nrange = [9, 0]',
            "stop[1].range: [9, 0]: the low end is not below the high end",
        ),
        (
            '[[stop]]\njoint = "crank"\nrange = [0, 400]',
            "stop[1].range: [0, 400]: 400 deg is more than a turn",
        ),
        (
            '[[stop]]\njoint = "crank"\nlimits = [0, 30]',
            "stop[1].limits: is not known here; give range = [low, high]",
        ),
        ('[[stop]]\njoint = "crank"\nrange = 30', "stop[1].range: 30 is not a range; give low and high"),
        ('[[stop]]\njoint = "crank"\nrange = [0, "3 mm"]', "stop[1].range: "),
        ('[[stop]]\njoint = "ball_b"\ncone = -4', "stop[1].cone: -4 deg is no cone; give an angle above 0"),
        (
            '[[stop]]\njoint = "ball_b"\ncone = 4\nseat = [0, 0, 0]',
            "stop[1].seat: [0, 0, 0] has no direction",
        ),
        (
            '[[stop]]\njoint = "ball_b"\ncone = 4\n[[stop]]\njoint = "ball_b"\ncone = 5',
            "stop[2].cone: joint 'ball_b' has a cone already",
        ),
        (
            "[[rod]]\nlink = 5\nradius = 3",
            "rod[1].link: 5 is not a link; give 1 to 4, the last is the ground",
        ),
        ("[[rod]]\nlink = 1\nradius = -3", "rod[1].radius: -3 is not a length; give a number > 0"),
        (
            "[[rod]]\nlink = 1\nradius = 3\n[[rod]]\nlink = 1\nradius = 4",
            "rod[2].link: link 1 has a radius already; leave one out",
        ),
        ("[[stop]]\nrange = [0, 3]", "stop[1].joint: is missing; needed here: joint"),
    ],
)
def test_each_mistake_has_its_message(tables, message):
    with pytest.raises(DescriptionError) as error:
        sb.loads(RSSR + tables)
    assert message in str(error.value)


def test_a_key_in_a_joint_s_own_table_is_sent_to_the_stops():
    text = gallery.text("rscr").replace('kind = "R"', 'kind = "R"\nrange = [0, 90]', 1)
    with pytest.raises(DescriptionError, match=r"range: is a key of \[\[stop\]\]; write it below that head"):
        sb.loads(text)


def test_the_report_has_ranges_bends_distances_and_what_can_be_used():
    motion = sb.loads(RSSR + STOPS).motion(72)
    page = markdown(motion)
    assert "- within the stops: circuit 0: " in page
    for words in (
        "bend of ball_a",
        "links 1 and 3",
        "-10.000° to 30.000°",
        "cone of ball_a",
        "723.55 mm left",
    ):
        assert words in page
    found = as_dict(motion)["circuits"][0]
    assert found["joint_ranges"]["crank"] == {"low": None, "low_at": None, "high": None, "high_at": None}
    assert found["joint_ranges"]["rocker"]["high"] == pytest.approx(1.18937, abs=1e-5)
    assert found["ball_cones"]["ball_a"]["limit"] == pytest.approx(math.radians(60))
    assert found["clearances"][0]["gap"] == pytest.approx(723.5495422, abs=1e-6)
    assert 0 < found["allowed"]["share"] < 1
    assert found["allowed"]["spans"][0]["first_stop"].startswith(("cone of", "range of"))
    plain = sb.load("rssr").motion(72)
    assert "bend of" not in markdown(plain)
    assert "bend of ball_b" in markdown(plain, ranges=True)
    with sb.language("zh"):
        assert "ball_b 的摆角" in markdown(plain, ranges=True)


def test_the_command_shows_and_writes_them(tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text(RSSR + STOPS)
    shown = sevenbar("analyze", str(file), "--samples", "36", "--json").stdout
    assert json.loads(shown)["circuits"][1]["allowed"]["share"] == 0.0
    sevenbar("analyze", str(file), "--samples", "36", "--out", str(tmp_path / "out"), "--figures", "svg")
    with (tmp_path / "out" / "motion.csv").open(newline="") as table:
        rows = list(csv.DictReader(table))
    bent = np.array([float(row["ball_a_bend_deg"]) for row in rows if row["circuit"] == "0"])
    within = np.array([row["within_stops"] == "1" for row in rows if row["circuit"] == "0"])
    assert within.any()
    assert (bent[within] <= 60 + 1e-9).all()


def test_the_studio_draws_a_circuit_pale_beyond_its_stops():
    motion = sb.loads(RSSR + STOPS).motion(72)
    views = [View(motion, circuit) for circuit in motion]
    (panel,) = panels(views, quantities(motion)[:1])
    assert "pale: beyond a stop" in panel.svg
    plain = sb.load("rssr").motion(72)
    (panel,) = panels([View(plain, circuit) for circuit in plain], quantities(plain)[:1])
    assert "beyond a stop" not in panel.svg
