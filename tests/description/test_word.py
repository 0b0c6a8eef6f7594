"""The word of a description: its transforms are what the form means, by formulas of their own."""

import math

import numpy as np
import pytest

import sevenbar as sb
from evidence.fuzz.random_loops import step
from sevenbar.description.draft import Draft
from sevenbar.description.forms import from_description
from sevenbar.description.gallery import loops
from sevenbar.errors import DescriptionError
from sevenbar.kinematics.loop.rigid import inverse, pose, unit
from sevenbar.kinematics.numbers.sensitivity import Numbers
from sevenbar.kinematics.numbers.word import word_of


def rssr(rng):
    """An RSSR by its dimensions; half of them leave the coupler out."""
    length = 10 ** rng.uniform(-1, 3, size=6)
    m, n, d = rng.normal(size=3) * length[:3]
    coupler = {} if rng.random() < 0.5 else {"L2": length[5]}
    return sb.rssr(M=m, N=n, D=d, L1=length[3], L3=length[4], **coupler)


def rows(rng):
    """Rows of any joints, in radians or with angles of quarters of a turn."""
    kinds = "R" + "".join(rng.choice(list("RPH"), size=rng.integers(2, 6))) + "R"
    count = len(kinds)
    quarters = rng.integers(-2, 3, size=count) * (math.pi / 2)
    twist = quarters if rng.random() < 0.3 else rng.uniform(-3, 3, size=count)
    return sb.from_dh(
        kinds,
        length=rng.normal(size=count),
        twist=twist,
        offset=[None if kind == "P" else x for kind, x in zip(kinds, rng.normal(size=count), strict=True)],
        angle=[x if kind == "P" else None for kind, x in zip(kinds, rng.normal(size=count), strict=True)],
        pitch=[0.3 if kind == "H" else None for kind in kinds],
        points=[{"name": "P", "link": int(rng.integers(1, count + 1)), "at": rng.normal(size=3)}],
    )


def drawn(rng):
    """Joints of any kind as drawn."""
    kinds = ["R", *rng.choice(list("RPHCUSE"), size=rng.integers(2, 6)), *rng.choice(list("RPHCUSE"), size=1)]
    joints = []
    for kind in kinds:
        joint = {"kind": str(kind), "at": rng.normal(size=3)}
        if kind in "RPHCE":
            joint["axis"] = rng.normal(size=3)
        if kind == "U":
            joint["axes"] = rng.normal(size=(2, 3))
        if kind == "H":
            joint["pitch"] = 0.3
        joints.append(joint)
    link = int(rng.integers(1, len(kinds) + 1))
    return sb.from_axes(joints, points=[{"name": "P", "link": link, "at": rng.normal(size=3)}])


def linkages(family, count):
    for seed in range(count):
        try:
            yield family(np.random.default_rng(seed))
        except DescriptionError:
            # two balls at one place, or a coupler without a length
            continue


def turned(value):
    """A turn about z."""
    return step(value, 0.0, 0.0, 0.0)


def word_at(linkage):
    """The word of a linkage's description, its numbers, and the transforms of its base, links and ground."""
    numbers = Numbers(linkage)
    values, word = numbers.values(numbers.nominal), word_of(linkage.form, linkage.kind, numbers.word.slots)
    return numbers, values, [one.pose(values) for one in (word.base, *word.links, word.ground)]


def check_rssr(linkage, rng):
    """By the paper's formulas of the balls, and its length of the coupler."""
    _, _, (base, crank, coupler, rocker, ground) = word_at(linkage)
    m, n, l1, l2, l3, d = (linkage.dimensions[key] for key in ("M", "N", "L1", "L2", "L3", "D"))
    alpha, beta = rng.uniform(-3, 3, size=2)
    a = (base @ turned(alpha) @ crank)[:3, 3]
    b = (ground @ turned(-beta) @ inverse(rocker))[:3, 3]
    size = max(abs(x) for x in linkage.dimensions.values())
    np.testing.assert_allclose(a, [l1 * math.cos(alpha), l1 * math.sin(alpha), n], atol=1e-14 * size)
    np.testing.assert_allclose(b, [m, d + l3 * math.cos(beta), l3 * math.sin(beta)], atol=1e-14 * size)
    np.testing.assert_allclose(coupler, pose(np.eye(3), [l2, 0.0, 0.0]))
    assert l2 == linkage.description["rssr"].get("L2", pytest.approx(math.hypot(l1 - m, l3, n), rel=1e-14))


def check_rows(linkage, rng):
    """By the product of all rows at any joint values, seen from the ground."""
    _, _, (base, *links, ground) = word_at(linkage)
    table, product, ours = linkage.description["link"], np.eye(4), base
    for i, (row, joint) in enumerate(zip(table, linkage.joints, strict=True)):
        q = rng.uniform(-3, 3)
        theta, offset = (row.get("angle", 0.0), q) if joint.kind == "P" else (q, row.get("offset", 0.0))
        offset += joint.pitch * q / math.tau
        product = product @ step(theta, offset, row.get("length", 0.0), row.get("twist", 0.0))
        moved = {"R": turned(q), "P": step(0.0, q, 0.0, 0.0)}.get(joint.kind)
        ours = ours @ (step(q, joint.pitch * q / math.tau, 0.0, 0.0) if moved is None else moved)
        ours = ours @ (links[i] if i < len(links) else inverse(ground))
    last = table[-1]
    seen = pose([[0, 0, 1], [1, 0, 0], [0, 1, 0]], np.zeros(3))
    seen = seen @ step(0.0, 0.0, last.get("length", 0.0), last.get("twist", 0.0))
    np.testing.assert_allclose(ours, seen @ product @ inverse(seen), atol=3e-13)


def check_drawn(linkage, _):
    """By places and axes: with all joints at zero each frame is where its joint is drawn, the last one reversed."""
    _, _, (base, *links, ground) = word_at(linkage)
    frame = base
    for i, (joint, table) in enumerate(zip(linkage.joints, linkage.description["joint"], strict=True)):
        np.testing.assert_allclose(frame[:3, 3], table["at"], atol=1e-12)
        # of a ball at the end x and z change places
        straight = (1, 0, 0) if joint.kind == "S" and i == len(links) else (0, 0, 1)
        first, second = table.get("axes", (table.get("axis", straight),) * 2)
        way = -1.0 if i == len(links) else 1.0
        np.testing.assert_allclose(frame[:3, 2], way * unit(first), atol=1e-12)
        if joint.kind == "U":
            c, s = math.cos(joint.angle), math.sin(joint.angle)
            frame = frame @ pose([[1, 0, 0], [0, c, -s], [0, s, c]], np.zeros(3))
        np.testing.assert_allclose(frame[:3, 2], way * unit(second), atol=1e-12)
        frame = frame @ (links[i] if i < len(links) else inverse(ground))
    np.testing.assert_allclose(frame, np.eye(4), atol=1e-12)


CHECKS = {"rssr": (rssr, check_rssr), "rows": (rows, check_rows), "drawn": (drawn, check_drawn)}


def checked(form, count):
    family, check = CHECKS[form]
    seen = 0
    for seed, linkage in enumerate(linkages(family, count)):
        check(linkage, np.random.default_rng([seed, 1]))
        seen += 1
    return seen


@pytest.mark.parametrize("name", loops())
def test_the_word_of_each_linkage_of_the_gallery_is_what_its_form_means(name):
    linkage = sb.load(name)
    if linkage.description.get("angle_unit", "deg") == "deg" and linkage.form == "rows":
        table = [dict(row) for row in linkage.description["link"]]
        for row in table:
            row |= {key: math.radians(row[key]) for key in ("twist", "angle") if key in row}
        linkage = from_description({**linkage.description, "angle_unit": "rad", "link": table})
    {"rssr": check_rssr, "rows": check_rows, "drawn": check_drawn}[linkage.form](
        linkage, np.random.default_rng(1)
    )


@pytest.mark.parametrize("form", list(CHECKS))
def test_the_words_of_random_descriptions_are_what_their_form_means(form):
    assert checked(form, 40) > 30


@pytest.mark.parametrize("count", [250, pytest.param(1000, marks=pytest.mark.proof)])
@pytest.mark.parametrize("form", list(CHECKS))
def test_the_words_of_hundreds_of_random_descriptions_are_what_their_form_means(form, count):
    assert checked(form, count) > 0.9 * count


def test_numbers_stand_in_the_order_of_the_file_without_the_speed():
    for name in loops():
        linkage = sb.load(name)
        every = [d.name for d in Draft.of_linkage(linkage).dimensions]
        assert [*Numbers(linkage).names, "speed"] == every
