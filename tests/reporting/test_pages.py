"""What a result says it says once: its page for people and its object for programs are the same facts."""

import io

import numpy as np
import pytest
from rich.console import Console

import sevenbar as sb
from sevenbar.design.tolerance.linear import linear_estimate
from sevenbar.design.tolerance.report import Findings, page_of
from sevenbar.design.tolerance.samples import monte_carlo
from sevenbar.design.tolerance.sensitivities import sensitivities
from sevenbar.design.tolerance.worst import worst_case
from sevenbar.measuring.calibrate import calibrate
from sevenbar.measuring.compare import compare
from sevenbar.measuring.measured import Measured
from sevenbar.measuring.report import calibration_page, comparison_page
from sevenbar.reporting import pose_forces
from sevenbar.reporting.page import Facts, facts_table, page


def tolerance_page():
    found = sensitivities(sb.load("rssr"), samples=24)
    linear = linear_estimate(found, {"L*": 0.5})
    return page_of(Findings(linear, worst_case(found, linear), monte_carlo(found, linear, 20)))


def measured():
    circuit = sb.load("rssr").motion(24).circuits[0]
    rocker = circuit.output + 1e-4 * np.sin(3 * circuit.input)
    return Measured("bench.csv", np.arange(2, 2 + len(rocker)), {"input": circuit.input, "angle": rocker})


def pose_forces_page():
    linkage = sb.load("rssr_press")
    pose = linkage.motion(24).circuits[0].at(0.5)
    return pose_forces.page_of(pose_forces.PoseForces(linkage, [(pose, pose.forces())]))


PAGES = {
    "forces in a pose": pose_forces_page,
    "tolerance": tolerance_page,
    "comparison": lambda: comparison_page(compare(sb.load("rssr"), measured(), align=["offset"])),
    "calibration": lambda: calibration_page(calibrate(sb.load("rssr"), measured(), free=["L1", "L3"])),
}


def printed(part):
    out = io.StringIO()
    Console(width=200, file=out).print(part)
    return out.getvalue()


@pytest.mark.parametrize("kind", PAGES)
def test_each_key_stands_once_and_has_a_label_where_people_read_it(kind):
    facts = PAGES[kind]().facts
    assert sum(len(fact.values) for fact in facts) == len(facts.as_dict)
    spoken = [fact for fact in facts if fact.text]
    assert spoken[0].label
    assert any(fact.values for fact in spoken)
    assert not [fact for fact in facts if fact.label and not (fact.text or fact.values)]


def test_a_fact_is_a_line_for_people_and_values_for_programs():
    facts = Facts()
    facts.also(format=1)
    facts.add("speed", "3 rad/s", speed=3.0)
    facts.add("", "by the file")
    facts.add("held", "", held={})
    assert facts.as_dict == {"format": 1, "speed": 3.0, "held": {}}
    assert printed(page("A title", facts)).split() == [
        "A",
        "title",
        "speed",
        "3",
        "rad/s",
        "by",
        "the",
        "file",
    ]


def test_a_row_of_facts_is_a_line_of_a_table_and_an_object():
    rows = []
    for name, value in (("L1", 250.0), ("L3", 550.0)):
        row = Facts()
        row.add("dimension", name, name=name, unit="mm")
        row.add("value", f"{value:g}", value=value)
        rows.append(row)
    lines = [line.split() for line in printed(facts_table(rows)).splitlines()]
    assert [lines[0], *lines[2:]] == [["dimension", "value"], ["L1", "250"], ["L3", "550"]]
    assert rows[1].as_dict == {"name": "L3", "unit": "mm", "value": 550.0}
