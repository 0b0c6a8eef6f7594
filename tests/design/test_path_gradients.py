"""The point of a loop and its derivatives, beside the core's analysis of linkages written anew."""

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.description.draft import Draft
from sevenbar.design.synthesis.path.task import path_task
from sevenbar.design.task.loop import TaskLoop
from sevenbar.errors import RequestError

#: Every form and every kind of joint: dimensions, rows, drawings; S S with its spin held, U, H, C, P.
LINKAGES = (
    "rssr",
    "seven_r",
    "spherical_4r",
    "planar_4r",
    "rscr",
    "rsur",
    "rssp",
    "sarrus",
    "screw_drill",
    "six_bar",
    "swash_plate",
)

#: Part of the size by which dimensions are changed for differences, and what these are good for.
STEP, GOOD = 1e-4, 2e-6


def drawn(name, link, at):
    """A linkage of the gallery with a point, its loop with all numbers free, and its first circuit."""
    draft = Draft.of_linkage(sb.load(name)).with_point("Q", link, at)
    loop = TaskLoop(draft, [d.name for d in draft.dimensions if d.kind != "speed"])
    circuit = draft.linkage.motion(12).circuits[0]
    return draft, loop, circuit


@pytest.mark.parametrize("name", LINKAGES)
def test_a_point_and_its_velocity_are_those_of_the_ordinary_analysis(name):
    for link in range(1, len(sb.load(name).links) + 1):
        size = sb.load(name).motion(12).circuits[0].size
        at = (0.3 * size, -0.2 * size, 0.15 * size)
        _, loop, circuit = drawn(name, link, at)
        rows = np.flatnonzero((circuit.status == "ok") & np.isfinite(circuit.q).all(axis=1))
        q = circuit.q[rows]
        # some way off, and closed again
        off = loop.poses(loop.start, q) + 1e-3 * np.cos(np.arange(q.size)).reshape(q.shape) * loop.units
        closed = loop.closed(loop.start, q[:, loop.input], off)
        here = loop.here(loop.start, closed[np.isfinite(closed).all(axis=1)])
        place = loop.named("Q")
        trace = circuit.point(link, at)
        assert len(here.points) == len(rows)
        assert here.points[:, place] == pytest.approx(trace.position[rows], abs=1e-9 * size)
        assert loop.here(loop.start, here.q, slopes=False).points == pytest.approx(
            here.points, abs=1e-12 * size
        )
        speed = circuit.dq[rows, loop.input, None]
        velocity = trace.velocity[rows]
        by_input = here.points_by[:, place, :, -1]
        assert by_input * speed == pytest.approx(velocity, abs=1e-8 * np.abs(velocity).max())


@pytest.mark.parametrize(
    ("name", "link"),
    [("rssr", 2), ("seven_r", 4), ("planar_4r", 2), ("rsur", 2), ("rssp", 2), ("six_bar", 3)]
    + [("swash_plate", link) for link in (1, 2)],
)
def test_derivatives_by_dimensions_are_those_of_linkages_written_with_other_dimensions(name, link):
    size = sb.load(name).motion(12).circuits[0].size
    draft, loop, circuit = drawn(name, link, (0.3 * size, -0.2 * size, 0.15 * size))
    row = int(np.flatnonzero((circuit.status == "ok") & np.isfinite(circuit.q).all(axis=1))[2])
    pose = loop.poses(loop.start, circuit.q[row : row + 1])
    x = pose[:, loop.input]
    here = circuit.point(link, draft.linkage.points[-1].at).position[row]
    place = loop.named("Q")
    assert loop.here(loop.start, pose).points[0, place] == pytest.approx(here, abs=1e-9 * size)
    exact = loop.here(loop.start, pose).points_by[0, place]
    opening = loop.openings(loop.start, pose)
    compared = 0
    for number, dimension in enumerate(loop.numbers.dimensions):
        if number in opening or dimension.follows:
            continue
        step = (
            STEP
            * {"length": size, "pitch": size, "number": 1.0, "angle": 1 / dimension.scale}[dimension.kind]
        )
        sides = []
        for way in (-2, -1, 1, 2):
            changed = {dimension.name: dimension.value + way * step}
            if name == "rssr":  # else the coupler follows the others
                changed = {"L2": draft.dimension("L2").value} | changed
            linkage = draft.with_values(changed).linkage
            motion = linkage.motion(law=sb.Law.of([0.0], x, 1.0, 0.0))
            point = linkage.points[-1]
            places = np.concatenate([c.point(point.link, point.at).position for c in motion])
            sides.append(places[np.linalg.norm(places - here, axis=1).argmin()])
        a, b, c, d = sides
        difference = (8 * (c - b) - (d - a)) / (12 * step)
        most = np.abs(difference).max() + size * 1e-3
        assert exact[:, number] == pytest.approx(difference, abs=GOOD * most), dimension.name
        compared += 1
    assert compared >= 6


def test_a_rod_that_follows_is_part_of_the_derivatives():
    """The point of linkages whose file leaves L2 out, at the crank's angle of a pose."""
    draft = Draft.of_linkage(sb.load("rssr")).with_point("Q", 3, (40.0, 60.0, 10.0))
    task = path_task(draft, [(0, 0, 1), (0, 1, 0), (1, 0, 0)], "Q", follow=["L2"], place=True)
    assert "L2" not in [dimension.name for dimension in task.dimensions]
    assert task.held.text == "L2 follows (997.497 mm in the design)"
    loop = task.loop
    circuit = draft.linkage.motion(12).circuits[0]
    x = circuit.input[3:4]
    here = loop.here(loop.start, loop.poses(loop.start, circuit.q[3:4]))
    exact = here.points_by[0, loop.named("Q")]
    for k, name in enumerate(d.name for d in task.dimensions):
        if name.startswith("Q."):
            continue
        places = []
        for step in (1e-3, -1e-3):
            own = {n: v for n, v in draft.linkage.dimensions.items() if n != "L2"}
            linkage = sb.rssr(**own | {name: own[name] + step})
            motion = linkage.motion(law=sb.Law.of([0.0], x, 1.0, 0.0))
            places.append(motion.circuits[0].point(3, (40.0, 60.0, 10.0)).position[0])
        assert exact[:, k] == pytest.approx((places[0] - places[1]) / 2e-3, abs=1e-7), name


def test_a_path_holds_the_rod_unless_it_varies_or_follows():
    draft = Draft.of_linkage(sb.load("rssr")).with_point("Q", 3, (40.0, 60.0, 10.0))
    points = [(0, 0, 1), (0, 1, 0), (1, 0, 0)]
    held = path_task(draft, points, "Q", vary=["L1", "L3"])
    assert held.held.text == "M, N, D, L2 (997.497 mm in the design)"
    longer = held.loop.drawn(np.array([260.0, 500.0])).linkage
    assert longer.dimensions["L2"] == draft.linkage.dimensions["L2"]
    follows = path_task(draft, points, "Q", vary=["L1", "L3"], follow=["L2"])
    rod = np.sqrt((260.0 - 700.0) ** 2 + 500.0**2 + 700.0**2)
    assert follows.loop.drawn(np.array([260.0, 500.0])).linkage.dimensions["L2"] == pytest.approx(
        rod, rel=1e-15
    )
    with pytest.raises(RequestError, match="vary: L2 is to follow from the others; leave one of the two out"):
        path_task(draft, points, "Q", vary=["L1", "L2"], follow=["L2"])


def test_a_twist_of_a_planar_loop_opens_it_and_a_length_does_not():
    _, loop, circuit = drawn("planar_4r", 2, (0.0, 1.0, 1.0))
    names = {loop.numbers.dimensions[number].name for number in loop.openings(loop.start, circuit.q)}
    assert names == {f"{key}_{link}" for key in ("offset", "twist") for link in (1, 2, 3, 4)}
