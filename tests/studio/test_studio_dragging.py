"""The studio under a restless hand: no fault, no growing memory, and never a mode shown that is none."""

import random
import re
import time
from pathlib import Path

import numpy as np
import pytest

from sevenbar.description.files import toml_text
from sevenbar.drawing.skeleton import places_of
from sevenbar.studio.server import StudioServer
from tab_client import TabClient, done

#: Growth of the process that is no leak [MB]: caches of sizes and fonts that come with what is drawn first.
GROWTH = 40.0
#: Each waits for seconds as a person does.

BAD = ("abc", "NaN", "0", "1e300", "-1e300", "", "1e-300", "30deg", "1,5", "<b>", "9" * 400)


def memory():
    """The memory of this process [MB]; Linux."""
    status = Path("/proc/self/status").read_text()
    return int(re.search(r"VmRSS:\s+(\d+) kB", status)[1]) / 1024


def visited(server):
    """A client at a server, and its tab once all of it is there."""
    known = server.tabs
    client = TabClient(server.address)
    for _ in range(12_000):
        if len(server.tabs) > len(known) and "completeness" in client.html():
            break
        time.sleep(0.05)
    client.settled(1.2)
    (tab,) = set(server.tabs) - set(known)
    client.worker = tab.worker
    return client, tab


def looked_at(session):
    """Asserts that what is on view is a mode of its linkage, on the circuit that is named."""
    view = session.view
    if view is None:
        return
    assert any(circuit is view.circuit for circuit in view.motion)
    if not session.problem:
        assert view.motion is session.motion
    q = view.joints(session.row)
    linkage = view.linkage
    shown = view.frame.pose(session.row)
    own = places_of(q[None], view.frame)[0]
    # between two rows a degree apart both are a little off
    assert np.nanmax(np.abs(own - shown)) < 5e-3 * view.frame.span
    row = min(round(session.row), len(view.path.rows) - 1)
    joints = view.circuit.q[view.path.rows[row]]
    modes = linkage.assembly_modes(float(joints[view.circuit.input_column]), input=view.motion.input)
    kept = [i for i, name in enumerate(linkage.columns) if name in linkage.drivable()]
    turns = np.array([linkage.turns(i) for i in kept])
    gaps = modes.q[:, kept] - joints[kept]
    gaps = np.where(turns, np.remainder(gaps + np.pi, 2 * np.pi) - np.pi, gaps / view.circuit.size)
    # at a dead centre, or a change point, two modes are one: to half the digits
    assert len(gaps)
    assert np.abs(gaps).max(axis=1).min() < 1e-5


def restless(client, dice):
    """One thing that a person does."""
    sliders = client.find("", "Slider")
    match dice.randrange(12):
        case 0:
            boxes = [u for u, p in client.gui.items() if p["kind"] == "GuiTextMessage" and "[" in p["label"]]
            box = dice.choice(boxes)
            client.write(box, dice.choice([*BAD, f"{dice.uniform(-500, 500):.4g}"]))
        case 1:
            client.put("history", dice.choice(["undo", "redo", "reset"]))
        case 2:
            client.click("Next mode at this input")
        case 3:
            client.put("circuit", dice.choice(client.gui[client.find("circuit")[0]]["options"]))
        case 4:
            client.write((client.find("Play") or client.find("Pause"))[0], True)
        case 5:
            client.put("ghosts", dice.choice(client.gui[client.find("ghosts")[0]]["options"]))
        case 6:
            curve = dice.choice(["curve 1", "curve 2", "curve 3"])
            client.put(curve, dice.choice(client.gui[client.find(curve)[0]]["options"]))
        case 7:
            client.put("step samples", dice.choice(["-10", "-1", "+1", "+10"]))
        case _:
            # a drag, faster than the studio can show it
            slider = dice.choice(sliders)
            props = client.gui[slider]
            value = client.values[slider]
            for _ in range(dice.randrange(3, 25)):
                value += dice.gauss(0, 0.01) * (props["max"] - props["min"])
                value = min(max(value, props["min"]), props["max"])
                client.write(slider, value)
                time.sleep(0.02)


@pytest.mark.parametrize("name", ["rssr", "seven_r"])
@pytest.mark.parametrize(
    "acts",
    [40, pytest.param(2400, marks=pytest.mark.proof)],
)
def test_random_dragging_never_fails_nor_grows_nor_shows_a_wrong_mode(name, acts, capsys):
    dice = random.Random(acts)
    server = StudioServer(toml_text(name), name, "127.0.0.1", 0)
    client, tab = visited(server)
    moved = 0
    for act in range(acts):
        if act == round(0.3 * acts):
            begun = memory()
        restless(client, dice)
        time.sleep(0.05)
        done(tab.worker, lambda: looked_at(tab.session))
        moved += not tab.session.problem
    grown = memory() - begun
    assert [told for told in client.told if "fault" in str(told).lower()] == []
    assert "Traceback" not in capsys.readouterr().err
    assert grown < GROWTH, f"{grown:.0f} MB more after {acts} acts"
    assert moved > acts / 4, "most of the time there is something to see"
    client.close()
    for _ in range(12_000):
        if not server.tabs:
            break
        time.sleep(0.05)
    assert server.tabs == ()
    tab.worker.join(60)
    assert not tab.worker.is_alive(), "a tab that is closed leaves no thread"
    server.stop()


def test_two_tabs_have_nothing_in_common():
    server = StudioServer(toml_text("rssr"), "rssr", "127.0.0.1", 0)
    one, other = (visited(server)[0] for _ in range(2))
    before = other.html()
    one.put("L1 [mm]", "260")
    one.until(lambda: one.html() != before)
    assert one.value("L1 [mm]") == "260"
    assert other.value("L1 [mm]") == "250"
    assert other.html() == before
    one.close()
    other.put("L3 [mm]", "560")
    # the one that stays goes on
    other.until(lambda: other.html() != before)
    server.stop()


def test_names_of_a_file_are_no_html():
    hostile = "<img src=x onerror=alert(1)>"
    text = (
        toml_text("rssr").replace("RSSR of Sun and Zhou", hostile)
        + f'\n[[point]]\nname = "{hostile}"\nlink = 2\nat = [1, 2, 3]\n'
    )
    server = StudioServer(text, hostile, "127.0.0.1", 0)
    client, _ = visited(server)
    assert "<img" not in client.html()
    assert "&lt;img" in client.html()
    client.put("L1 [mm]", hostile)
    time.sleep(1.2)
    client.settled(0.5)
    assert "<img" not in client.html()
    server.stop()


def bodies(client):
    return [name for name in client.scene if name.startswith("/linkage/")]


def test_what_never_moved_is_not_drawn_and_can_be_mended():
    far = toml_text("rssr").replace("D = 0", "D = 0\nL2 = 5000")
    server = StudioServer(far, "far", "127.0.0.1", 0)
    client, tab = visited(server)
    assert "cannot-assemble" in client.html()
    assert "stays in grey" not in client.html()
    assert bodies(client) == []
    client.put("L2 [mm]", "997")
    client.until(lambda: "crank-rocker" in client.html() and bodies(client))
    # another file that does not move is not shown as the one before
    done(tab.worker, lambda: tab.session.open(far, "far"))
    client.until(lambda: not bodies(client))
    client.put("history", "undo")
    client.until(lambda: "crank-rocker" in client.html() and bodies(client))
    server.stop()
