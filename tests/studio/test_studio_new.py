"""New linkages, pulled points and saved files, by the wire that the page speaks."""

import time
from dataclasses import replace

import numpy as np
import pytest
from test_studio_dragging import visited

import sevenbar as sb
from double_constraint import DOUBLE
from sevenbar.description.draft import Draft
from sevenbar.description.files import toml_text
from sevenbar.studio.server import StudioServer
from sevenbar.studio.state.sketch import beginning, drawn, kinds_of
from tab_client import TabClient, done
from textbook_loops import linkage

#: Each waits for seconds as a person does.

FOUR_BAR = drawn("Four", "mm", beginning(kinds_of("RRRR")))


def served(tmp_path, text=FOUR_BAR, name="four.toml"):
    path = tmp_path / name
    path.write_text(text)
    return StudioServer(text, str(path), "127.0.0.1", 0, tmp_path), path


def handles(client):
    return sorted(name.removeprefix("/handles/") for name in client.scene if name.startswith("/handles/"))


def saved(client):
    """Presses the button, not the folder of the same name."""
    client.write(client.find("Save", "Button")[0], True)


def test_points_are_pulled_and_a_pull_is_one_step(tmp_path):
    server, _ = served(tmp_path)
    client, tab = visited(server)
    assert handles(client) == []
    client.put("step samples", "+10")
    client.until(lambda: tab.session.row == 10.0)
    client.put("drag points", True)
    client.until(lambda: handles(client) == ["joint_0", "joint_1", "joint_2", "joint_3"])
    assert tab.session.row == 0.0, "it is shown as drawn"
    stage = tab._scenery.stage
    start = client.places["/handles/joint_2"]
    assert np.allclose(start, stage.in_scene(np.array([100.0, 80.0, 0.0])), atol=1e-6)
    ends = [np.array([x, 85.037, 0.0]) for x in (101.0, 103.0, 104.98)]
    client.pull("joint_2", *(stage.in_scene(end) for end in ends))
    client.until(lambda: client.value("x [mm]", "Text") == "0" and len(tab.session.past) == 1)
    at = [d.value for d in tab.session.draft.dimensions if d.place[:3] == ("joint", 2, "at")]
    assert at == [105.0, 85.0, 0.0]
    client.until(
        lambda: np.allclose(client.places["/handles/joint_2"], stage.in_scene(np.array(at)), atol=1e-6)
    )
    client.pull("joint_1", stage.in_scene(np.array([5.0, 40.0, 0.0])))
    client.until(lambda: len(tab.session.past) == 2)
    for _ in range(2):
        client.put("history", "undo")
        time.sleep(0.1)
    client.until(lambda: not tab.session.past)
    assert tab.session.draft.raw == sb.loads(FOUR_BAR).description
    assert np.allclose(client.places["/handles/joint_2"], start, atol=1e-6)
    # a linkage that is moved is no longer as drawn
    client.put("step samples", "+10")
    client.until(lambda: handles(client) == [])
    assert client.value("drag points") is False
    assert [said for said in client.told if "fault" in str(said).lower()] == []
    client.close()
    server.stop()


def test_a_planar_linkage_is_seen_square_to_its_plane_and_pulled_by_two_arrows(tmp_path):
    server, _ = served(tmp_path)
    client, tab = visited(server)
    eye, target = tab._scenery.stage.look()
    assert np.allclose((eye - target)[:2], 0.0, atol=1e-9)
    assert np.allclose(done(tab.worker, lambda: np.array(tab._client.camera.up_direction)), [0, 1, 0])
    client.put("drag points", True)
    client.until(lambda: len(handles(client)) == 4)
    arrows = {handle.active_axes for handle in tab._handles._handles.values()}
    assert arrows == {(True, True, False)}
    # a linkage in space stands again, with three arrows
    client.put(
        "gallery", next(o for o in client.gui[client.find("gallery")[0]]["options"] if o.startswith("rscr:"))
    )
    client.until(lambda: tab.session.draft.linkage.kind == "RSCR")
    client.until(lambda: len(handles(client)) == 4)
    assert {handle.active_axes for handle in tab._handles._handles.values()} == {(True, True, True)}
    assert np.allclose(done(tab.worker, lambda: np.array(tab._client.camera.up_direction)), [0, 0, 1])
    assert [said for said in client.told if "fault" in str(said).lower()] == []
    client.close()
    server.stop()


def test_a_linkage_none_of_whose_motions_can_be_followed_is_shown_as_drawn_with_the_reason(
    tmp_path, monkeypatch
):
    # of such loops none is quick: a motion without its circuits stands for them
    motion = sb.Linkage.motion

    def unfollowed(self, *given, **named):
        return replace(motion(self, *given, **named), motion_type="not-followed", circuits=())

    monkeypatch.setattr(sb.Linkage, "motion", unfollowed)
    server, _ = served(tmp_path, Draft.of_linkage(linkage(DOUBLE)).toml())
    client, tab = visited(server)
    client.until(lambda: any(name.startswith("/linkage/") for name in client.scene))
    assert tab.session.view is None
    assert "not-followed" in client.html()
    assert "none of its motions could be followed" in client.html()
    client.put("drag points", True)
    client.until(lambda: len(handles(client)) == 4)
    assert [said for said in client.told if "fault" in str(said).lower()] == []
    client.close()
    server.stop()


def test_a_new_linkage_begins_with_a_planar_four_bar(tmp_path):
    server, _ = served(tmp_path)
    client, _ = visited(server)
    assert client.value("kind").startswith("planar_4r:")
    client.close()
    server.stop()


@pytest.mark.parametrize(("name", "pulled"), [("five_rod", "rod_1_1"), ("watt", "pin_2")])
def test_a_net_is_pulled_at_pins_and_ends_of_rods_and_shows_no_fault(tmp_path, name, pulled):
    server, _ = served(tmp_path, toml_text(name))
    client, tab = visited(server)
    client.put("drag points", True)
    client.until(lambda: pulled in handles(client))
    assert len(handles(client)) == len({tuple(client.places[f"/handles/{one}"]) for one in handles(client)})
    client.pull(pulled, client.places[f"/handles/{pulled}"] + np.array([0.02, 0.01, 0.0]))
    client.until(lambda: len(tab.session.past) == 1)
    assert tab.session.problem == ""
    client.put("history", "undo")
    client.until(lambda: not tab.session.past)
    assert [said for said in client.told if "fault" in str(said).lower()] == []
    client.close()
    server.stop()


def test_the_points_of_another_form_are_pulled_where_they_are(tmp_path):
    server, _ = served(tmp_path, toml_text("seven_r"))
    client, tab = visited(server)
    client.put("go to input", "60")
    client.until(lambda: abs(tab.session.row - 60) < 1e-6)
    client.put("drag points", True)
    client.until(lambda: handles(client) == ["point_0"])
    assert "The dimensions of this form are changed in the boxes below" in client.html()
    stage, session = tab._scenery.stage, tab.session
    client.pull("point_0", client.places["/handles/point_0"] + np.array([0.1, 0.0, 0.0]))
    client.until(lambda: len(session.past) == 1)
    name = session.draft.raw["point"][0]["name"]
    place = session.view.frame.points[[p.name for p in session.view.linkage.added_points].index(name)]
    shown = done(tab.worker, lambda: session.view.frame.pose(session.row)[place])
    assert (
        np.abs(shown - stage.from_scene(client.places["/handles/point_0"])).max()
        < 1e-3 * session.view.frame.span
    )
    client.close()
    server.stop()


def test_a_linkage_is_made_of_a_kind_and_drawn_of_joints_and_saved(tmp_path):
    server, path = served(tmp_path)
    client, tab = visited(server)
    client.put("new name", "Mine")
    client.put(
        "kind", next(o for o in client.gui[client.find("kind")[0]]["options"] if o.startswith("bennett:"))
    )
    client.click("Make this kind")
    client.until(lambda: tab.session.draft.linkage.name == "Mine")
    assert tab.session.motion.motion_type == sb.load("bennett").motion().motion_type
    client.put("joints", "R R R P")
    client.until(lambda: client.find("joint 4: P"))
    client.put("in", "cm")
    client.click("Draw these joints")
    client.until(lambda: tab.session.draft.linkage.kind == "RRRP")
    assert tab.session.motion.motion_type == "crank-slider"
    assert client.value("file") == "Mine.toml"
    saved(client)
    client.until(lambda: (tmp_path / "Mine.toml").exists())
    assert sb.load(tmp_path / "Mine.toml").length_unit == "cm"
    assert path.read_text() == FOUR_BAR
    client.put("joints", "R X")
    client.until(lambda: "&#x27;X&#x27; is not a kind of joint" in client.html())
    client.put("history", "undo")
    client.until(lambda: tab.session.draft.linkage.kind == "RRRR")
    # what does not move is drawn all the same, so that it can be pulled to where it does
    client.put("joints", "R R R")
    client.until(lambda: client.find("joint 3: R"))
    client.click("Draw these joints")
    client.until(lambda: tab.session.view is None and any(n.startswith("/linkage/") for n in client.scene))
    client.put("drag points", True)
    client.until(lambda: len(handles(client)) == 3)
    client.put("history", "undo")
    client.until(lambda: tab.session.view is not None and handles(client) == [])
    assert [said for said in client.told if "fault" in str(said).lower()] == []
    client.close()
    server.stop()


def test_save_writes_the_file_that_was_opened_and_asks_where_it_has_changed(tmp_path):
    commented = FOUR_BAR.replace("[[joint]]", "# the first\n[[joint]]", 1)
    server, path = served(tmp_path, commented)
    client, tab = visited(server)
    assert client.value("file") == "four.toml"
    client.put("y [mm]", "-3")
    client.until(lambda: tab.session.past)
    saved(client)
    client.until(lambda: path.read_text() != commented)
    assert path.read_text() == commented.replace("at = [0, 0, 0]", "at = [0, -3, 0]")
    # a page that is loaded again has what was saved
    again = TabClient(server.address)
    again.until(lambda: again.find("y [mm]") and again.value("y [mm]", "Text") == "-3")
    again.close()
    path.write_text(commented + "# by hand\n")
    client.put("y [mm]", "-4")
    client.until(lambda: len(tab.session.past) == 2)
    saved(client)
    client.until(lambda: "four.toml: it has changed since it was read" in client.html())
    assert path.read_text() == commented + "# by hand\n"
    client.click("Replace it")
    client.until(lambda: "-4" in path.read_text())
    assert "has changed since" not in client.html()
    client.put("file", "../up.toml")
    saved(client)
    client.until(lambda: "is not the name of a file in" in client.html())
    assert sorted(file.name for file in tmp_path.iterdir()) == ["four.toml"]
    client.close()
    server.stop()


def test_served_to_others_nothing_is_saved_here(tmp_path):
    server = StudioServer(FOUR_BAR, "four.toml", "0.0.0.0", 0, tmp_path)
    client, _ = visited(server)
    (button,) = client.find("Save", "Button")
    assert client.gui[button]["visible"] is False
    saved(client)
    client.settled(0.5)
    assert list(tmp_path.iterdir()) == []
    client.close()
    server.stop()
