"""Derivatives by the numbers of a description against those of poses and rates in many digits."""

import math
from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest

import sevenbar as sb
from evidence.accuracy import precise_loops, reference_rssr
from evidence.accuracy.differences import central_differences
from evidence.accuracy.precise_loops import PreciseLoop
from evidence.accuracy.reference_loops import Loop
from evidence.fuzz.random_linkages import Dimensions
from evidence.fuzz.random_loops import general, prismatic
from sevenbar.kinematics.numbers.sensitivity import Numbers

#: Change of a number in the differences in many digits; their error is its square.
STEP = mp.mpf(10) ** -9

#: Digits in which drawn loops are closed by the exponentials of their lines.
DIGITS = 60


def poses(linkage, input, output, count=5, circuit=0):
    """Closed poses spread over a circuit: the loop, all its columns, and the column of the output."""
    found = linkage.motion(40, input=input, output=output, method="general").circuits[circuit]
    well = np.flatnonzero((found.status == "ok") & (found.condition < 1e3))
    rows = well[np.linspace(0, len(well) - 1, count).astype(int)]
    numbers = Numbers(linkage)
    loop = numbers.loop(found.input_column)
    q = loop.closed(found.input[rows], numbers.poses(found.q[rows]))
    return loop, q, found.output_column


@pytest.mark.parametrize(
    ("driver", "other", "dims"),
    [
        ("crank", "rocker", Dimensions(700, 700, 250, 550, 0, 997.4968671630002)),
        ("crank", "rocker", Dimensions(640, -710, 210, 500, 130, 900)),
        ("rocker", "crank", Dimensions(640, -710, 210, 500, 130, 900)),
    ],
)
def test_an_rssr_s_derivatives_by_its_dimensions_are_those_in_80_digits(driver, other, dims):
    loop, q, column = poses(dims.linkage(), driver, other)
    found = loop.slopes(q).by_number[:, :, :, column]
    with mp.workdps(reference_rssr.DIGITS):
        for k, name in enumerate(loop.numbers.names):
            value = getattr(dims, name)
            # both are numbers of double precision, their difference is exact
            high, low = (value + sign * 2.0**-14 for sign in (1, -1))
            sides = [replace(dims, **{name: v}).reference().precise() for v in (high, low)]
            for row in range(len(q)):
                rates = [side.output((q[row, loop.input], 1, 0, 0), q[row, column], driver) for side in sides]
                for order in range(3):
                    slope = float((rates[0][order] - rates[1][order]) / mp.mpf(high - low))
                    size = np.abs(found[:, order]).max()
                    assert found[row, order, k] == pytest.approx(slope, abs=1e-9 * size)


def precise_rows(loop, values):
    """The fixed transforms of rows R of these numbers in many digits: Tz(offset) Tx(length) Rx(twist)."""
    precise = PreciseLoop(loop)
    precise.fixed = [
        [
            [mp.mpf(1), mp.mpf(0), mp.mpf(0), values[f"length_{i}"]],
            [mp.mpf(0), mp.cos(values[f"twist_{i}"]), -mp.sin(values[f"twist_{i}"]), mp.mpf(0)],
            [mp.mpf(0), mp.sin(values[f"twist_{i}"]), mp.cos(values[f"twist_{i}"]), values[f"offset_{i}"]],
        ]
        for i in range(1, 8)
    ]
    return precise


@pytest.mark.parametrize("name", ["seven_r", "random"])
def test_a_7r_s_derivatives_by_its_dimensions_are_those_in_60_digits(name):
    linkage = sb.load("seven_r") if name == "seven_r" else general(np.random.default_rng(4)).linkage()
    loop, q, column = poses(linkage, "theta_1", "theta_7", count=1)
    found = loop.slopes(q, 3).by_number[:, :, :, column]
    reference = Loop.of(linkage)
    dimensions = [d for d in loop.numbers.dimensions if d.place[0] == "link"]
    with mp.workdps(precise_loops.DIGITS):
        exact = {d.name: mp.mpf(d.value) * mp.mpf(d.scale) for d in dimensions}
        for k, d in enumerate(dimensions):
            sides = [precise_rows(reference, exact | {d.name: exact[d.name] + s * STEP}) for s in (1, -1)]
            for row in range(len(q)):
                rates = [
                    side.along((q[row, 0], 1, 0, 0), reference.polished(q[row], 0)[0])[6] for side in sides
                ]
                for order in range(4):
                    slope = float((rates[0][order] - rates[1][order]) / (2 * STEP)) * d.scale
                    # a third difference of a step of 1e-14 has 18 digits, over a step of 1e-9 nine of them
                    close = 1e-10 if order < 3 else 1e-7
                    size = np.abs(found[:, order]).max()
                    assert found[row, order, k] == pytest.approx(slope, abs=close * size)


class Lines:
    """A drawn loop in many digits: the product of exponentials of its lines is the identity."""

    def __init__(self, linkage, near):
        self.table, self.near = linkage.description["joint"], near

    def values(self, dimensions):
        """Every number of the joints, in many digits."""
        return {d.place: mp.mpf(d.value) for d in dimensions if d.place[0] == "joint"}

    def product(self, values, q):
        """The product (4, 4) at joint values."""
        whole, column = mp.eye(4), 0
        for i, table in enumerate(self.table):
            at = self._vector(values, "joint", i, "at")
            if table["kind"] == "S":
                lines = [("turn", mp.matrix([int(k == axis) for k in range(3)]), 0) for axis in (2, 1, 0)]
            elif table["kind"] == "U":
                lines = [("turn", self._vector(values, "joint", i, "axes", k), 0) for k in (0, 1)]
            else:
                axis = self._vector(values, "joint", i, "axis")
                pitch = values.get(("joint", i, "pitch"), 0)
                lines = {
                    "R": [("turn", axis, 0)],
                    "P": [("slide", axis, 0)],
                    "H": [("turn", axis, pitch / (2 * mp.pi))],
                    "C": [("turn", axis, 0), ("slide", axis, 0)],
                }[table["kind"]]
            # the last joint moves the link before it against the ground, so the ground the other way
            last = i == len(self.table) - 1
            for kind, axis, advance in lines[::-1] if last and table["kind"] == "S" else lines:
                whole = whole * self._step(kind, axis, at, -q[column] if last else q[column], advance)
                column += 1
        return whole

    def _vector(self, values, *place):
        return mp.matrix([values[*place, k] for k in range(3)])

    def _step(self, kind, axis, at, q, advance):
        x, y, z = axis / mp.norm(axis)
        odd = mp.matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        turn = mp.eye(3)
        slide = q
        if kind == "turn":
            turn = turn + mp.sin(q) * odd + (1 - mp.cos(q)) * odd * odd
            slide = advance * q
        place = at - turn * at + slide * mp.matrix([x, y, z])
        matrix = mp.eye(4)
        matrix[:3, :3] = turn
        for k in range(3):
            matrix[k, 3] = place[k]
        return matrix

    def errors(self, values, q):
        """The closure error, six numbers."""
        t = self.product(values, q)
        turned = [(t[2, 1] - t[1, 2]) / 2, (t[0, 2] - t[2, 0]) / 2, (t[1, 0] - t[0, 1]) / 2]
        return [*turned, *(t[k, 3] / self.size for k in range(3))]

    def prepared(self, values, input, held, size):
        """Newton's chord at the pose nearby, of the columns that follow."""
        self.size, self.input = size, input
        self.free = [k for k in range(len(self.near)) if k != input and k not in held]
        columns = []
        h = mp.mpf(10) ** -20
        for k in self.free:
            sides = [
                self.errors(values, [q + s * h * (j == k) for j, q in enumerate(self.near)]) for s in (1, -1)
            ]
            columns.append([float((a - b) / (2 * h)) for a, b in zip(*sides, strict=True)])
        # the equations that count
        chord = np.linalg.pinv(np.array(columns).T, rcond=1e-9)
        self.chord = [[mp.mpf(x) for x in row] for row in chord]
        return self

    def closed(self, values, x):
        """The joint values at an input."""
        q = list(self.near)
        q[self.input] = x
        for _ in range(60):
            error = self.errors(values, q)
            steps = [mp.fdot(zip(row, error, strict=True)) for row in self.chord]
            for k, step in zip(self.free, steps, strict=True):
                q[k] -= step
            if max(map(abs, steps)) < mp.mpf(10) ** -(DIGITS - 8) * self.size:
                return q
        raise ArithmeticError("the loop does not close")


def held_columns(numbers):
    """Columns that the core holds, and one turn of each ball whose link it holds from spinning."""
    _, columns, spins = numbers.linkage.held
    assert spins == 0
    return columns


@pytest.mark.parametrize(
    ("name", "orders"),
    [
        pytest.param("rscr", 1),
        ("rsur", 3),
        ("rssp", 1),
        ("screw_drill", 3),
        ("five_bar", 1),
        ("sarrus", 1),
    ],
)
def test_derivatives_of_drawn_loops_are_those_in_60_digits_for_every_kind_of_joint(name, orders):
    linkage = sb.load(name)
    circuit = linkage.motion(12).circuits[0]
    row = int(np.flatnonzero(circuit.status == "ok")[1])
    numbers = Numbers(linkage)
    loop = numbers.loop(circuit.input_column)
    q = loop.closed(circuit.input[row : row + 1], numbers.poses(circuit.q[row : row + 1]))
    here = loop.slopes(q, 2)
    ours, idle = numbers.by_columns(circuit.q[row : row + 1], here)
    compared = 0
    with mp.workdps(DIGITS):
        lines = Lines(linkage, [mp.mpf(float(x)) for x in circuit.q[row]])
        exact = lines.values(numbers.dimensions)
        lines.prepared(exact, circuit.input_column, held_columns(numbers), numbers.size)
        x = mp.mpf(float(circuit.input[row]))
        h, step = mp.mpf(10) ** -8, mp.mpf(10) ** -15
        for k, d in enumerate(numbers.dimensions):
            if d.place[0] != "joint" or here.opening[k]:
                continue
            sides = []
            for sign in (1, -1):
                values = exact | {d.place: exact[d.place] + sign * step}
                inputs = [0] if orders == 1 else [-2, -1, 0, 1, 2]
                sides.append([lines.closed(values, x + n * h) for n in inputs])
            for column in range(len(linkage.columns)):
                if idle[column] or column == circuit.input_column:
                    continue
                slopes = [(a[column] - b[column]) / (2 * step) for a, b in zip(*sides, strict=True)]
                wanted = slopes if orders == 1 else central_differences(slopes, h)
                for order in range(1 if numbers.is_ball[column] else orders):
                    size = np.nanmax(np.abs(ours[0, order, :, column]))
                    close = 1e-10 * max(size, np.nanmax(np.abs(ours[0, order])) * 1e-3)
                    assert ours[0, order, k, column] == pytest.approx(float(wanted[order]), abs=close)
                    compared += 1
    # of an RSSP all but the slide spins idly, or is a ball's
    assert compared >= 18


@pytest.mark.parametrize(
    ("name", "input"),
    [("rssr", "crank"), ("seven_r", "theta_1"), ("rsur", None), ("rssp", None), ("screw_drill", None)],
)
def test_rates_by_the_input_are_those_of_the_motion_up_to_the_jerk(name, input):
    linkage = sb.load(name)
    circuit = linkage.motion(24, input=input, speed=1.0).circuits[0]
    numbers = Numbers(linkage)
    loop = numbers.loop(circuit.input_column)
    rows, q = loop.poses(circuit)
    found = loop.slopes(q, 3)
    column = circuit.output_column
    assert len(rows) == 24
    for order, rates in enumerate((circuit.dq, circuit.ddq, circuit.dddq)):
        size = np.abs(rates[:, column]).max()
        for ours in (found.rates, found.by_input):
            np.testing.assert_allclose(ours[:, order, column], rates[:, column], rtol=0, atol=1e-12 * size)


def test_slides_and_screws_of_rows_have_derivatives_too():
    for linkage in (prismatic(2)(np.random.default_rng(3)).linkage(), sb.load("rccc")):
        loop, q, column = poses(linkage, linkage.drive.joint, linkage.drive.output)
        numbers = loop.numbers
        found = loop.slopes(q)
        for k in range(len(numbers.names)):
            step = 1e-6 * numbers.units[k]
            sides = []
            for sign in (1, -1):
                p = numbers.nominal + sign * step * np.eye(len(numbers.names))[k]
                there = loop.closed(q[:, loop.input], q, p)
                rates = numbers.loop(loop.input, p, ()).slopes(there, 0).rates
                sides.append(np.concatenate([there[:, None], rates], axis=1)[:, :3, column])
            slopes = (sides[0] - sides[1]) / (2 * step)
            size = np.abs(found.by_number[:, :, :, column]).max(axis=(0, 2))
            for order in range(3):
                ours = found.by_number[:, order, k, column]
                np.testing.assert_allclose(ours, slopes[:, order], rtol=0, atol=1e-7 * size[order])


def test_changed_dimensions_are_followed_to_a_closed_pose():
    linkage = sb.load("seven_r")
    loop, q, _ = poses(linkage, "theta_1", "theta_7", count=12)
    numbers = loop.numbers
    moved = numbers.nominal * 1.01
    there = loop.closed(q[:, 0], q, moved)
    rows = {d.name: v * d.scale for d, v in zip(numbers.dimensions, moved, strict=True)}
    other = sb.from_dh(
        "RRRRRRR",
        **{word: [rows[f"{word}_{i}"] for i in range(1, 8)] for word in ("length", "twist", "offset")},
    )
    assert Loop.of(other).errors(there).max() < 1e-12


def test_a_pose_beyond_a_dead_centre_is_no_pose_of_the_same_pass():
    linkage = sb.load("rssr")
    circuit = linkage.motion(720, input="rocker").circuits[0]
    numbers = Numbers(linkage)
    loop = numbers.loop(circuit.input_column)
    row = int(np.flatnonzero(circuit.status == "ok")[3])
    q = numbers.poses(circuit.q[row : row + 1])
    x = circuit.input[row]
    limit = min(circuit.input_range, key=lambda end: abs(end - x))
    assert np.isnan(loop.closed(limit + 0.01 * np.sign(limit - x), q)).all()
    # the pose itself, and a way short of the limit
    assert np.isfinite(loop.closed(x + 0.5 * (limit - x), q)).all()


def test_a_planar_loop_keeps_its_offsets_and_twists_and_tells_its_lengths():
    linkage = sb.load("planar_4r")
    loop, q, _ = poses(linkage, linkage.drive.joint, linkage.drive.output)
    opening = np.array(loop.numbers.names)[loop.slopes(q).opening]
    assert set(opening) == {f"{word}_{i}" for word in ("offset", "twist") for i in range(1, 5)}


def test_what_opens_a_loop_does_not_depend_on_its_unit_of_length():
    for size in (1e-6, 1e6):
        linkage = sb.from_dh(
            "RRRR", length=[40 * size, 100 * size, 80 * size, 90 * size], twist=[0] * 4, offset=[0] * 4
        )
        loop, q, _ = poses(linkage, linkage.drive.joint, linkage.drive.output)
        assert loop.slopes(q).opening.sum() == 8


@pytest.mark.parametrize("name", ["rssr", "seven_r", "rsur", "rssp"])
def test_the_derivative_by_all_lengths_together_is_nothing(name):
    linkage = sb.load(name)
    loop, q, column = poses(linkage, linkage.drive.joint, linkage.drive.output)
    if not linkage.turns(column):
        column = linkage.columns.index(linkage.drive.joint) - 1
    lengths = np.where([d.kind == "length" for d in loop.numbers.dimensions], loop.p, 0.0)
    column = next(k for k in range(len(linkage.columns)) if k != loop.input and loop.numbers.turns[k])
    found = loop.slopes(q)
    for order in range(3):
        assert np.abs(found.by_number[:, order, :, column] @ lengths).max() < 1e-12 * math.pi


def test_idle_joints_are_named_and_the_others_told():
    # two turns about one axis: the second moves nothing but the link between
    joints = [
        {"kind": "R", "at": (0, 0, 0), "axis": (0, 0, 1)},
        {"kind": "R", "at": (40, 0, 0), "axis": (0, 0, 1)},
        {"kind": "R", "at": (40, 0, 30), "axis": (0, 0, 1)},
        {"kind": "R", "at": (100, 70, 0), "axis": (0, 0, 1)},
        {"kind": "R", "at": (120, 0, 0), "axis": (0, 0, 1)},
    ]
    linkage = sb.from_axes(joints)
    plain = sb.from_axes([joint for k, joint in enumerate(joints) if k != 2])
    found = {}
    for one in (linkage, plain):
        numbers = Numbers(one)
        circuit = one.motion(12).circuits[0]
        loop = numbers.loop(0)
        here = loop.slopes(loop.poses(circuit)[1])
        place = numbers.names.index(f"{one.joints[-2].name}.x")
        found[one is plain] = here.by_number[:, :, place, -1], here.idle
    np.testing.assert_allclose(found[False][0], found[True][0], rtol=1e-9, atol=1e-12)
    assert found[False][1].tolist() == [False, True, True, False, False]
    assert not found[True][1].any()
