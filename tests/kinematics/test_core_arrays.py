"""The core reads arrays row by row, however they lie in memory."""

import numpy as np
import pytest

import sevenbar as sb
from sevenbar import _core
from sevenbar.curves.along import Along
from sevenbar.kinematics.numbers.sensitivity import Numbers

RNG = np.random.default_rng(0)


def by_columns(array):
    return np.asfortranarray(array)


def with_gaps(array):
    spaced = np.full([2 * n for n in array.shape], np.nan)
    spaced[tuple(slice(None, None, 2) for _ in array.shape)] = array
    return spaced[tuple(slice(None, None, 2) for _ in array.shape)]


@pytest.mark.parametrize("laid", [by_columns, with_gaps])
def test_a_numbered_loop_reads_poses_and_designs_by_rows(laid):
    linkage = sb.load("seven_r")
    loop = Numbers(linkage).loop(0)
    _, poses = loop.poses(linkage.motion(24).circuits[0])
    poses = np.ascontiguousarray(poses)
    assert not laid(poses).flags.c_contiguous
    inputs = poses[:, 0]
    designs = loop.p + 1e-3 * RNG.normal(size=(3, len(loop.p)))
    steps = 1e-4 * RNG.normal(size=(3, *poses.shape))
    core = loop.core
    for own, other in (
        (core.slopes(poses, 1), core.slopes(laid(poses), 1)),
        ([core.places(poses)], [core.places(laid(poses))]),
        (
            core.follow(poses, inputs, designs, steps),
            core.follow(laid(poses), laid(inputs), laid(designs), laid(steps)),
        ),
    ):
        for one, two in zip(own, other, strict=True):
            np.testing.assert_array_equal(one, two)


@pytest.mark.parametrize("laid", [by_columns, with_gaps])
def test_rows_batches_and_series_are_read_by_rows(laid):
    # the M, N, L1, L2, L3, D of three linkages
    dimensions = np.array(
        [[0.0, 0.1, 0.2], [0.0, 0.1, 0.3], [1, 1.1, 1.2], [3, 3.1, 3.3], [2.0, 2.5, 2.6], [3, 3, 3]]
    )
    for own, other in zip(
        _core.classify_rssr(dimensions, "crank", 1),
        _core.classify_rssr(laid(dimensions), "crank", 1),
        strict=True,
    ):
        np.testing.assert_array_equal(own, other)
    series = RNG.normal(size=(4, 5, 3))
    edges, places = np.arange(5.0), np.linspace(0, 4, 9)
    own = _core.piecewise(edges, series, places)
    np.testing.assert_array_equal(_core.piecewise(laid(edges), laid(series), laid(places)), own)
    np.testing.assert_array_equal(Along(edges, laid(series)).at(places), own)
