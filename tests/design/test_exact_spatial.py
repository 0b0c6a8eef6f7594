"""Dyads CC and RC, and the Bennett linkage: their number, known ones again, special tasks."""

import itertools

import numpy as np
import pytest

import sevenbar as sb
from exact_tasks import coupler_poses, lines_of, random_poses, worst_miss
from sevenbar.design.exact import bennett_poses, cc_dyads, rccc_poses
from sevenbar.design.exact.bennett import factor, norm_of, times
from sevenbar.design.exact.given import poses_given
from sevenbar.design.exact.lines import places
from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits import poses as circuit_poses
from sevenbar.kinematics.loop.rigid import about, inverse, pose, unit


def screw(axis, at, angle, slide):
    """The motion about a line."""
    axis = unit(axis)
    x, y, z = axis
    tilde = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turn = np.eye(3) + np.sin(angle) * tilde + (1 - np.cos(angle)) * tilde @ tilde
    return pose(turn, at - turn @ at + slide * axis)


def same_line(at, axis, other_at, other_axis):
    apart = np.cross(np.subtract(at, other_at), axis)
    return max(np.abs(np.cross(axis, other_axis)).max(), np.abs(apart).max() / 50)


def test_a_hundred_tasks_of_five_poses_have_six_dyads_cc():
    real = []
    for seed in range(100):
        found = cc_dyads(random_poses(5, seed))
        assert found.complete
        assert found.theory == 6
        assert found.real in (0, 2, 4, 6)
        assert max([a.error for a in found.answers], default=0.0) < 1e-9
        real.append(found.real)
    assert {2, 4, 6} <= set(real)


def test_linkages_cccc_have_two_freedoms_and_no_verdict():
    poses = random_poses(5, 0)
    found = cc_dyads(poses)
    answer = found.answers[0]
    # at the values of all joints, link 2 has the wanted poses
    there = circuit_poses.poses(answer.linkage, answer.poses)[:, 1]
    assert there @ inverse(there[0]) == pytest.approx(poses @ inverse(poses[0]), abs=1e-9)
    assert answer.verdict is None
    assert answer.fault is None
    assert answer.linkage.motion().motion_type == "two-inputs"
    assert not found.defect_free
    assert "two freedoms" in repr(found)


def test_a_known_dyad_cc_is_found_again():
    rng = np.random.default_rng(3)
    for _ in range(20):
        (a, b), (p, q) = rng.normal(size=(2, 3)), rng.uniform(-30, 30, (2, 3))
        start = random_poses(1, 4)[0]
        steps = [(0.0, 0.0, 0.0, 0.0), *rng.uniform(-1, 1, (4, 4)) * [2, 20, 2, 20]]
        moved = [screw(a, p, s[0], s[1]) @ screw(b, q, s[2], s[3]) @ start for s in steps]
        found = cc_dyads(np.array(moved))
        assert found.complete
        assert found.real >= 2
        assert len(found.dyads) == found.real
        off = [
            max(
                same_line(p, unit(a), dyad.ground.at, dyad.ground.axis),
                same_line(q, unit(b), dyad.body.at, dyad.body.axis),
            )
            for dyad in found.dyads
        ]
        assert min(off) < 1e-7


def test_a_known_dyad_rc_follows_from_the_direction_of_its_moving_line():
    rng = np.random.default_rng(3)
    for _ in range(20):
        (a, b), (p, q) = rng.normal(size=(2, 3)), rng.uniform(-1, 1, (2, 3))
        steps = [(0.0, 0.0, 0.0), *rng.uniform(-1, 1, (2, 3)) * [2, 2, 1]]
        moved = [screw(a, p, s[0], 0.0) @ screw(b, q, s[1], s[2]) for s in steps]
        task = poses_given(np.array(moved), 3, 3)
        forms = task.turns - np.eye(3)
        direction = unit(np.cross(*(forms @ unit(b))))
        assert np.abs(np.cross(direction, unit(a))).max() < 1e-10
        found = places(direction, unit(b), "RC", task)
        assert found is not None
        for at, place, axis in zip(found, (p, q), (a, b), strict=True):
            assert np.abs(np.cross(at * task.reach - place, unit(axis))).max() < 1e-8


def test_three_poses_have_linkages_rccc_that_move():
    poses = random_poses(3, 1)
    found = rccc_poses(poses, samples=2)
    assert [a.linkage.kind for a in found.answers] == ["RCCC", "RCCC"]
    assert found.theory is None
    for answer in found.answers:
        assert answer.error < 1e-12
        assert answer.fault in (None, "circuit", "dead centre", "order")
        assert worst_miss(answer, poses @ inverse(poses[0])) < 1e-6


@pytest.mark.parametrize(
    ("poses", "said"),
    [
        (
            pose([about(2, 0.3 * i) @ about(0, 0.1 * i * i) for i in range(5)]),
            r"about one point, \(0, 0, 0\)",
        ),
        (
            pose([about(2, 0.3 * i) for i in range(5)], [(i, i * i, i) for i in range(5)]),
            "about one direction",
        ),
        (pose([np.eye(3)] * 5, [(i, i * i, i) for i in range(5)]), "all have one orientation"),
        (random_poses(4, 0), "4 are given; give 5"),
        (np.zeros((5, 4, 4)), "last row"),
    ],
)
def test_poses_without_dyads_say_so(poses, said):
    with pytest.raises(RequestError, match=said):
        cc_dyads(poses)


@pytest.mark.parametrize("seed", range(10))
def test_three_poses_have_one_bennett_linkage_without_defects(seed):
    poses = random_poses(3, seed)
    found = bennett_poses(poses)
    assert (found.theory, found.found, found.real, len(found.answers)) == (6, 6, 2, 2)
    assert len(found.defect_free) == 2
    at, axes = lines_of(found.answers[0])
    links = np.roll(at, -1, axis=0) - at
    lengths = np.linalg.norm(links, axis=1)
    sines = np.linalg.norm(np.cross(axes, np.roll(axes, -1, axis=0)), axis=1)
    # Bennett's conditions: opposite links alike, lengths as the sines, no offsets
    assert lengths[:2] == pytest.approx(lengths[2:], rel=1e-9)
    assert lengths / sines == pytest.approx(np.full(4, lengths[0] / sines[0]), rel=1e-9)
    assert np.abs((links * axes).sum(axis=1)).max() < 1e-9 * lengths.max()
    assert found.answers[0].error < 1e-9
    assert worst_miss(found.answers[0], poses @ inverse(poses[0])) < 1e-8


@pytest.mark.parametrize("tasks", [30, pytest.param(100, marks=pytest.mark.proof)])
def test_random_tasks_have_one_bennett_linkage_each(tasks):
    for seed in range(tasks):
        found = bennett_poses(random_poses(3, seed))
        assert found.complete
        assert found.real == 2
        assert len(found.defect_free) == 2
        assert max(a.error for a in found.answers) < 1e-9


def test_a_known_bennett_linkage_is_found_again():
    rng = np.random.default_rng(1)
    for _ in range(20):
        a, alpha, beta = rng.uniform(20, 80), *rng.uniform(0.3, 1.4, 2)
        linkage = sb.bennett(a, alpha, beta)
        circuit = linkage.motion(36).circuits[0]
        found = bennett_poses(coupler_poses(circuit, np.array([2, 9, 17])))
        other = a * np.sin(beta) / np.sin(alpha)
        at, _ = lines_of(found.answers[0])
        lengths = np.sort(np.linalg.norm(np.roll(at, -1, axis=0) - at, axis=1))
        assert lengths == pytest.approx(np.sort([a, a, other, other]), rel=1e-7)
        assert len(found.defect_free) == 2


@pytest.mark.parametrize(
    ("turns", "shifts", "said"),
    [
        ([np.eye(3), about(2, 0.5), about(0, 0.7)], [(0, 0, 0)] * 3, r"poses\[1\]: is a turn about one line"),
        ([np.eye(3), about(2, 0.3), about(2, 0.6)], [(0, 0, 0), (1, 2, 0), (4, 1, 0)], "about one direction"),
        (
            [np.eye(3), about(2, np.pi / 2), about(0, np.pi / 2)],
            [(0, 0, 0), (10, 0, 10), (0, 10, 10)],
            r"poses\[2\]: is a turn",
        ),
        (
            [np.eye(3), about(2, np.pi), about(0, np.pi)],
            [(0, 0, 0), (10, 0, 10), (10, 10, 0)],
            "dyads of these",
        ),
    ],
)
def test_poses_without_a_bennett_linkage_say_so(turns, shifts, said):
    with pytest.raises(RequestError, match=said):
        bennett_poses(pose(turns, shifts))


def test_both_factorings_of_a_motion_polynomial_give_it_back():
    rng = np.random.default_rng(0)
    turns = []
    for _ in range(2):
        direction, place = unit(rng.normal(size=3)), rng.normal(size=3)
        vector = rng.uniform(0.5, 2) * direction
        turns.append(np.concatenate([[rng.normal()], vector, [0.0], np.cross(place, vector)]).astype(complex))
    first, second = turns
    c1, c0 = -(first + second), times(first, second)
    zeros = np.roots(norm_of(c1, c0))
    found = [factor(c1, c0, -x - y, x * y) for x, y in itertools.combinations(zeros, 2)]
    assert min(np.abs(h - second).max() for h in found) < 1e-12
    for h in found:
        assert np.abs(times(-c1 - h, h) - c0).max() < 1e-10


@pytest.mark.parametrize("seed", range(3))
def test_a_search_from_many_complex_starts_finds_the_same_six_dyads_rr(seed):
    """Newton's method on the equations of a dyad of two turning joints, reduced to the moving direction."""
    task = poses_given(random_poses(3, seed, reach=1.0), 3, 3)
    rng = np.random.default_rng(seed)
    starts = rng.normal(size=(900, 2)) + 1j * rng.normal(size=(900, 2))
    found = searched(task.turns, task.shifts, starts)
    from sevenbar.design.exact.bennett import _conic, _zeros

    c1, c0 = _conic(task)
    ours = []
    for x, y in itertools.combinations(_zeros(c1, c0), 2):
        vector = factor(c1, c0, -x - y, x * y)[1:4]
        ours.append(vector[1:] / vector[0])
    # nothing else is found; and of the six at least five by so few starts
    assert all(min(np.abs(v - o).max() for o in ours) < 1e-5 * (1 + np.abs(v).max()) for v in found)
    assert len(found) >= 5


def missed(chart, turns, shifts):
    """What two of the eight equations miss where the other six hold, for directions (1, y, z)."""
    b = np.column_stack([np.ones(len(chart), complex), chart])
    b /= np.sqrt((b * b).sum(axis=1))[:, None]
    a = np.cross(b @ (turns[0] - np.eye(3)).T, b @ (turns[1] - np.eye(3)).T)
    a /= np.sqrt((a * a).sum(axis=1))[:, None]
    c = (a * b).sum(axis=1)[:, None]
    sides, right = np.zeros((len(b), 8, 6), complex), np.zeros((len(b), 8), complex)
    sides[:, 0, :3], sides[:, 1, 3:], row = a, b, 2
    for turn, shift in zip(turns, shifts, strict=True):
        moved = b @ turn.T
        pairs = ((np.cross(a, moved), np.cross(a, b)), (a - c * moved, a - c * b), (moved - c * a, b - c * a))
        for then, now in pairs:
            sides[:, row, :3], sides[:, row, 3:] = now - then, then @ turn - now
            right[:, row] = -(then @ shift)
            row += 1
    kept, rest = [0, 1, 2, 3, 5, 6], [4, 7]
    inverted = np.linalg.pinv(np.nan_to_num(sides[:, kept]) + 1e-300 * np.eye(6), rcond=1e-14)
    x = (inverted @ np.nan_to_num(right[:, kept])[..., None])[..., 0]
    return np.einsum("nij,nj->ni", sides[:, rest], x) - right[:, rest], a, b, x


def searched(turns, shifts, chart, step=1e-6):
    with np.errstate(all="ignore"):
        for _ in range(50):
            now = missed(chart, turns, shifts)[0]
            sides = [
                (missed(chart + e, turns, shifts)[0] - missed(chart - e, turns, shifts)[0]) / (2 * step)
                for e in step * np.eye(2)
            ]
            slopes = np.stack(sides, axis=-1)
            sound = np.isfinite(slopes).all(axis=(1, 2)) & np.isfinite(now).all(axis=1)
            slopes = np.where(sound[:, None, None], slopes, np.eye(2))
            sound &= np.abs(np.linalg.det(slopes)) > 1e-30
            chart, now, slopes = chart[sound], now[sound], slopes[sound]
            move = np.linalg.solve(slopes, now[..., None])[..., 0]
            chart = chart - move * np.minimum(1, 1 / np.maximum(np.abs(move).max(axis=1), 1e-300))[:, None]
        now, a, b, x = missed(chart, turns, shifts)
    size = 1 + np.abs(x).max(axis=1)
    good = (np.abs(now).max(axis=1) < 1e-9 * size) & (np.abs(chart).max(axis=1) < 1e3) & (size < 1e4)
    # parallel lines make all equations empty
    good &= np.abs((a * b).sum(axis=1) ** 2 - 1) > 1e-6
    found = []
    for point in chart[good]:
        if all(np.abs(point - other).max() > 1e-6 * (1 + np.abs(point).max()) for other in found):
            found.append(point)
    return found
