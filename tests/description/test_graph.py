"""Links and joints as a graph: of one loop the ring in its order, of several the same questions."""

from typing import get_args

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.description.gallery import loops
from sevenbar.drawing.joint_shapes import shape_of
from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits.poses import joint_frames, poses
from sevenbar.kinematics.loop.graph import Graph, loop_graph
from sevenbar.kinematics.loop.joints import KINDS, ShapeName

#: A Watt six-bar: ground 6; links 1, 2, 3 close on it, and 4, 5 from link 3 to it again.
WATT = Graph(((6, 1), (1, 2), (2, 3), (3, 6), (3, 4), (4, 5), (5, 6)))


@pytest.mark.parametrize("graph", [loop_graph("RRRR"), loop_graph("RR"), loop_graph("RSSR"), WATT])
def test_a_link_s_joints_are_those_between_it_and_its_neighbours(graph):
    for link in graph.links:
        assert sorted(graph.joints_of(link)) == [j for j in graph.joints if link in graph.between[j]]
        for joint, other in zip(graph.joints_of(link), graph.neighbours(link), strict=True):
            assert {link, other} == set(graph.between[joint])
            assert graph.between[joint][graph.side(joint, link)] == link
            assert link in graph.neighbours(other)


@pytest.mark.parametrize(("graph", "loops"), [(loop_graph("RRRRRRR"), 1), (loop_graph("RR"), 1), (WATT, 2)])
def test_the_tree_reaches_each_moving_link_once_and_every_other_joint_closes_a_loop(graph, loops):
    reached = {graph.ground}
    for joint in graph.tree:
        first, second = graph.between[joint]
        assert (first in reached) != (second in reached)
        reached |= {first, second}
    assert reached == set(graph.links)
    assert len(graph.closing) == loops


def test_the_ground_may_have_more_than_two_joints():
    assert WATT.standing == (0, 3, 6)
    assert [WATT.moving_link(joint) for joint in WATT.standing] == [1, 3, 5]


def test_a_link_that_is_not_at_a_joint_is_refused():
    with pytest.raises(RequestError, match="link: link 3 is not at joint 0; give 4 or 1"):
        loop_graph("RRRR").side(0, 3)


@pytest.mark.parametrize("name", loops())
def test_a_joint_s_frames_on_both_links_are_apart_by_its_own_motion(name):
    linkage = sb.load(name)
    q = linkage.motion(12).circuits[0].q
    q = q[np.isfinite(q).all(axis=1)]
    frames = poses(linkage, q)
    np.testing.assert_array_equal(frames[:, -1], np.broadcast_to(np.eye(4), (len(q), 4, 4)))
    assert joint_frames(linkage, frames)[0].shape == (len(q), len(linkage.joints), 4, 4)
    for i, joint in enumerate(linkage.joints):
        before, after = (frames[:, link - 1] @ linkage.joint_on(i, link) for link in linkage.graph.between[i])
        moved = before @ joint.motion(q[:, linkage.places[i]])
        np.testing.assert_allclose(moved, after, atol=1e-9 * max(1.0, linkage.size))


def test_a_column_carries_what_its_joint_says_of_it():
    linkage = sb.load("rssr")
    assert [column.name for column in linkage.each_column] == list(linkage.columns)
    for column in linkage.each_column:
        joint = linkage.joints[column.joint]
        assert column.name in joint.columns
        assert column.is_output is not joint.row.is_ball
        assert linkage.column_of(column.name) is linkage.column_of(column.number) is column
    assert sb.slider_crank(125, 500).column_of(3).text(12.5) == "12.5 mm"
    assert linkage.column_of("crank").text(np.pi / 6) == "30 deg"


def test_each_kind_of_joint_has_a_shape_and_each_shape_a_kind():
    assert {kind.shape for kind in KINDS.values()} == set(get_args(ShapeName))
    for kind in KINDS.values():
        assert shape_of(kind).legend
        assert shape_of(kind).marks
