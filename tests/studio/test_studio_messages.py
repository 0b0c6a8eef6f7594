"""What a page sends is heeded if the studio's own page could have sent it; anything else is nothing at all."""

import random
import time

import msgspec
import pytest

from evidence.benches.cases.studio_client import CAMERA
from sevenbar.description.files import toml_text
from sevenbar.studio.messages import MESSAGES, is_heeded
from sevenbar.studio.server import StudioServer
from tab_client import TabClient

WRONG = (
    None, True, -1, 0, 3, 2**63, 1e308, float("nan"), float("inf"), "", "no such thing", "x" * 20_000, "a\x00\x1b\nb",
    b"bytes", [], {}, [1, 2], [1, 2, 3], [float("nan"), 0, 0], [None], ["a", 1], {"a": 1}, [[]], "__class__",
)  # fmt: skip

GARBAGE = (b"", b"\x00", b"\xc1", b"\xff" * 40, b"\x91" * 100_000, msgspec.msgpack.encode([1, 2]), b"\x80")


def packed(**message):
    return msgspec.msgpack.encode(message)


@pytest.fixture(scope="module")
def served():
    server = StudioServer(toml_text("rssr"), "rssr", "127.0.0.1", 0)
    yield server
    server.stop()


def test_messages_of_the_page_are_heeded_and_no_others():
    good = {**CAMERA, "wxyz": list(CAMERA["wxyz"])}
    assert is_heeded(msgspec.msgpack.encode(good))
    assert is_heeded(packed(type="GuiUpdateMessage", uuid="a", updates={"value": 3}))
    assert not is_heeded("text")
    for raw in GARBAGE:
        assert not is_heeded(raw)
    for name, wrong in [
        (name, wrong) for name in CAMERA for wrong in WRONG if wrong not in (0, 3, -1, [1, 2, 3])
    ]:
        assert not is_heeded(msgspec.msgpack.encode({**good, name: wrong})), (name, wrong)
    for name in CAMERA:
        assert not is_heeded(
            msgspec.msgpack.encode({key: value for key, value in good.items() if key != name})
        )
    for name in (
        "GuiFormDirtyMessage",
        "ShareUrlRequest",
        "ScenePointerMessage",
        "GuiModalMessage",
        "Message",
        "",
    ):
        assert not is_heeded(packed(type=name, uuid="a"))


@pytest.mark.parametrize(
    "name", ["__class__", "_impl", "update_cb", "removed", "props", "value_", "disabled"]
)
def test_no_property_of_a_control_but_its_value_is_set(name):
    assert not is_heeded(packed(type="GuiUpdateMessage", uuid="a", updates={name: 3}))
    assert not is_heeded(packed(type="GuiUpdateMessage", uuid="a", updates={"value": 3, name: 3}))


def test_wrong_messages_change_nothing_print_nothing_and_leave_the_tab_at_work(served, capfd):
    chance = random.Random(5)
    tab = TabClient(served.address)
    try:
        tab.until(lambda: served.tabs and tab.gui)
        (own,) = served.tabs
        before = dict(tab.values)
        for raw in GARBAGE:
            tab._socket.send(raw)
        tab._socket.send("text")
        for kind, checks in MESSAGES.items():
            for _ in range(60):
                fields = {name: chance.choice(WRONG) for name in checks}
                if "uuid" in fields and chance.random() < 0.8:
                    fields["uuid"] = chance.choice(list(tab.gui))
                if "updates" in fields:
                    fields["updates"] = {chance.choice(("value", "__class__", "_impl")): chance.choice(WRONG)}
                tab._send({"type": kind, **fields})
        kinds = {uuid: made["kind"] for uuid, made in tab.gui.items()}
        # a value of the right kind may be taken: what a person types is judged by the panels
        plain = ("Slider", "Checkbox", "Dropdown", "ButtonGroup", "Vector3", "Number", "Upload")
        for uuid, kind in kinds.items():
            for wrong in (None, [], {}, [1, 2], b"a", float("nan"), "no such thing", {"a": 1}):
                if any(word in kind for word in plain):
                    tab._send({"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": wrong}})
        tab.settled()
        assert tab.values.keys() >= before.keys()
        assert own.worker.is_alive()
        tab.put("speed", tab.gui[tab.find("speed")[0]]["options"][0])
        tab.settled()
    finally:
        tab.close()
    out, err = capfd.readouterr()
    assert (out, err) == ("", "")


def test_a_page_that_sends_anything_to_every_control_prints_no_traceback(served, capfd):
    chance = random.Random(6)
    tab = TabClient(served.address)
    try:
        tab.until(lambda: served.tabs and tab.gui)
        controls = [
            uuid for uuid, made in tab.gui.items() if "Text" in made["kind"] or "Slider" in made["kind"]
        ]
        for uuid in controls:
            tab.write(uuid, chance.choice([value for value in WRONG if isinstance(value, (int, str))]))
            time.sleep(0.01)
        tab.settled(quiet=1.0)
    finally:
        tab.close()
    assert "Traceback" not in capfd.readouterr().err
