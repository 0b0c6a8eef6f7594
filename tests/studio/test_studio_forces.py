"""Forces in the studio: curves, switches, arrows and peaks are those of the circuit's forces."""

from __future__ import annotations

import math
import re
from typing import Any
from unittest.mock import MagicMock

import numpy as np
import pytest
import viser

import sevenbar as sb
from browser import keep, settled
from controls import choose, open_tab, options, shown, toggle
from desk import SHOWN, Desk
from places import DOCS
from sevenbar.arrays import Floats
from sevenbar.description.gallery import text
from sevenbar.drawing.quantities import Quantity, quantities
from sevenbar.kinematics.answers import LinkageAnswers
from sevenbar.studio.panels.forces import ForcesPanel
from sevenbar.studio.state.acting import ALL_OFF, SwitchedLoading, drive_sizing, known_force
from sevenbar.studio.state.session import Session
from sevenbar.studio.svg.curves import panels
from sevenbar.studio.svg.picture import Panel
from sevenbar.studio.worker import Worker
from studio_pictures import texts, ticks, value_at
from studio_sessions import DOUBLE_ROCKER, opened

ROCKING = DOUBLE_ROCKER + "[forces]\ngravity = [0, 0, -9.81]\n[[body]]\nlink = 3\nmass = 2\nsolid = 'rod'\n"
SPRING = "[[spring]]\njoint = 'rocker'\nstiffness = '3 N m/rad'\n"
WORK = "\n[[load]]\nname = 'work'\nlink = 3\nat = [0, 0, 0]\nforce = [0, 0, 5]\n"


def offered(session: Session) -> dict[str, Quantity]:
    assert session.view is not None
    found = quantities(session.view.motion, session.acting)
    return {quantity.name: quantity for quantity in found if quantity.acting}


def panel_of(session: Session, name: str) -> Panel:
    assert session.view is not None
    return panels(session.views, [offered(session)[name]], session.view.circuit.index)[0]


# --- curves


def test_curves_of_forces_are_the_circuits_forces_read_at_the_ticks() -> None:
    session = opened("rssr_press")
    view = session.view
    assert view is not None
    forces, rows = view.circuit.forces(), view.path.rows
    rocker = forces.reactions["rocker"]
    wanted = {
        "input torque": forces.torque,
        "power": forces.power,
        "kinetic energy": forces.kinetic,
        "potential energy": forces.potential,
        "shaking force": np.linalg.norm(forces.shaking[:, 3:], axis=1),
        "rocker force": np.linalg.norm(rocker.force_in_report, axis=1),
        "rocker radial force": np.linalg.norm(rocker.force[:, :2], axis=1),
    }
    for name, values in wanted.items():
        panel = panel_of(session, name)
        np.testing.assert_allclose(panel.values, values[rows], rtol=1e-12)
        _, beside = ticks(panel)
        power = 10.0 ** (panel.scale.power if panel.scale else 0)
        read = value_at(beside, panel.y) * power
        np.testing.assert_allclose(read, values[rows], atol=2e-3 * float(np.ptp(values)))
        (told,) = texts(panel.cursor(90))
        assert told.text.endswith(offered(session)[name].unit)


def test_a_ball_has_no_radial_force_and_a_slide_is_pushed_by_a_force() -> None:
    assert "ball_a force" in offered(opened("rssr_press"))
    assert "ball_a radial force" not in offered(opened("rssr_press"))
    slider = sb.load("rssp").loaded(bodies={1: sb.Body(1.0, solid="rod")})
    motion = slider.motion(input="slider")
    offers = quantities(motion, SwitchedLoading(slider))
    (first,) = (one for one in offers if one.row.word == "input torque")
    assert (first.name, first.unit) == ("input force", "N")


def test_names_that_are_taken_are_told_apart() -> None:
    joints = [
        {"kind": "R", "at": (0, 0, 0), "axis": (0, 0, 1), "name": "shaking"},
        {"kind": "S", "at": (0, 100, 0)},
        {"kind": "S", "at": (220, 130, 0)},
        {"kind": "R", "at": (200, 0, 0), "axis": (0, 0, 1)},
    ]
    linkage = sb.from_axes(joints).loaded(bodies={1: sb.Body(1.0, solid="rod")})
    names = [one.name for one in quantities(linkage.motion(samples=36), SwitchedLoading(linkage))]
    assert {"shaking force", "shaking force (joint)"} <= set(names)
    assert len(set(names)) == len(names)


def test_dead_centres_leave_gaps_and_the_power_turns_with_the_input() -> None:
    session = Session(ROCKING, "rocking")
    view = session.view
    assert view is not None
    dead = view.circuit.status[view.path.rows] == "dead-centre"
    assert dead.any()
    torque, power = (panel_of(session, name).values for name in ("input torque", "power"))
    np.testing.assert_array_equal(np.isnan(torque), dead)
    np.testing.assert_allclose(power[~dead], (torque * view.path.sign * 2.0)[~dead], rtol=1e-9)
    assert (view.path.sign < 0).any()
    gap = int(np.flatnonzero(dead)[0])
    assert [told.text for told in texts(panel_of(session, "power").cursor(gap))] == ["no value"]


def test_a_force_that_is_not_determined_says_so_in_place_of_a_curve() -> None:
    session = opened("engine")
    empty = panel_of(session, "crank force")
    assert not empty.values.size
    assert "not determined: constraints are redundant" in [told.text for told in texts(empty.svg)]
    assert np.isfinite(panel_of(session, "crank radial force").values).all()


def test_rounding_is_drawn_as_zero() -> None:
    # a rod at rest in itself about an upright axis: nothing turns it
    session = Session(text("rssr") + "\n[[body]]\nlink = 1\nmass = 3\nsolid = 'rod'\n", "rod")
    panel = panel_of(session, "input torque")
    assert np.abs(panel.values).max() < 1e-9
    _, top, _, bottom = panel.frame.box
    assert np.ptp(panel.y) < 0.01 * (bottom - top)


# --- nothing that acts costs nothing


def test_without_bodies_nothing_is_offered_and_nothing_computed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(LinkageAnswers, "forces", lambda *_args, **_more: pytest.fail("computed"))
    session = opened("rssr")
    assert session.acting.is_empty
    assert session.acting.switches == ()
    assert not offered(session)
    # and with bodies before a curve of forces is chosen
    loaded = opened("rssr_press")
    assert loaded.view is not None
    assert len(offered(loaded)) == 11
    loaded.change(("rssr", "M"), 690.0)
    panels(loaded.views, quantities(loaded.view.motion)[:3], 0)


def test_forces_of_a_circuit_are_computed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    session = opened("rssr_press")
    assert session.view is not None
    counted: list[Any] = []
    own = LinkageAnswers.forces

    def forces(answers: LinkageAnswers, circuit: Any, given: Any, **more: Any) -> Any:
        counted.append(circuit)
        return own(answers, circuit, given, **more)

    monkeypatch.setattr(LinkageAnswers, "forces", forces)
    for name in ("input torque", "power", "rocker force"):
        panel_of(session, name)
    assert len(counted) == len(session.views)


# --- switches


def test_switches_are_gravity_loads_and_springs_by_their_names() -> None:
    twice = WORK + WORK.replace("5]", "7]")
    session = Session(ROCKING + WORK.replace("work", "press") + twice + SPRING, "many")
    assert [switch.name for switch in session.acting.switches] == [
        "gravity",
        "press",
        "load 2 work",
        "load 3 work",
        "spring 1",
    ]


def test_switched_off_is_what_the_linkage_gives_without_it_and_the_file_stays() -> None:
    session = opened("rssr_press")
    draft, view = session.draft, session.view
    assert view is not None
    own = draft.linkage
    for key, without in {
        "gravity": own.loaded(gravity=(0, 0, 0)),
        "load 1": own.loaded(gravity=(0, 0, 0), loads=[]),
    }.items():
        session.switch(key, on=False)
        wanted = without.motion(360).circuits[0].forces()
        np.testing.assert_allclose(session.acting.forces(view).torque, wanted.torque, rtol=1e-9, atol=1e-9)  # type: ignore[union-attr]
    assert session.draft is draft
    assert session.view is view
    assert not session.past
    session.switch("gravity", on=True)
    session.switch("load 1", on=True)
    np.testing.assert_array_equal(panel_of(session, "input torque").values[:-1], view.circuit.forces().torque)


def test_switches_stay_while_a_dimension_changes_and_not_in_another_file() -> None:
    session = opened("rssr_press")
    session.switch("load 1", on=False)
    session.change(("rssr", "M"), 690.0)
    assert session.acting.off == {"load 1"}
    assert session.acting.linkage is session.draft.linkage
    session.open(text("engine"), "engine")
    assert not session.acting.off


def test_a_switch_that_a_person_has_just_turned_is_not_set_back() -> None:
    # viser has the value before anybody is told of it; in between the panel may be shown for another reason
    session, server = opened("rssr_press"), viser.ViserServer(port=0, verbose=False)
    try:
        panel = ForcesPanel(server.gui, Worker(int, int, int), session, MagicMock())
        panel.show()
        boxes = {box.label: box for box in panel._boxes}
        boxes["work"]._impl.value = False
        panel.show()
        assert not boxes["work"].value
        session.switch("load 1", on=False)
        panel.show()
        session.switch("load 1", on=True)
        panel.show()
        assert all(box.value for box in boxes.values())
    finally:
        server.stop()


def test_with_all_switched_off_and_no_mass_the_panel_says_so() -> None:
    session = Session(text("rssr") + WORK, "load")
    session.switch("load 1", on=False)
    assert session.view is not None
    assert session.acting.forces(session.view) is None
    assert any("nothing acts" in told.text for told in texts(panel_of(session, "input torque").svg))
    assert session.acting.reason(session.view) == ALL_OFF


def test_a_body_that_cannot_be_is_a_reason_and_no_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuses(*_: Any, **_more: Any) -> None:
        raise sb.errors.RequestError("bodies: link 2 has no length")

    session = opened("rssr_press")
    assert session.view is not None
    monkeypatch.setattr(LinkageAnswers, "forces", refuses)
    assert session.acting.forces(session.view) is None
    assert session.acting.reason(session.view) == "bodies: link 2 has no length"


# --- peaks and arrows


def test_the_manual_has_the_peaks_of_the_press_with_its_work_and_without() -> None:
    manual = (DOCS / "studio.md").read_text(encoding="utf-8")
    press = sb.load("rssr_press")
    peaks = [one.motion(360).circuits[0].forces().sizing() for one in (press.loaded(loads=[]), press)]
    light, work = (abs(peak.peak_torque.value) for peak in peaks if peak is not None)
    assert f"is {light:.0f} N m in place of {work:.0f} N m" in manual


@pytest.mark.parametrize("name", ["rssr_press", "engine"])
def test_the_peaks_of_the_drive_are_those_of_the_sizing(name: str) -> None:
    forces = sb.load(name).motion(360).circuits[0].forces()
    found, wanted = drive_sizing(forces), forces.sizing()
    assert found is not None
    assert wanted is not None
    assert (found.peak_torque, found.rms_torque) == (wanted.peak_torque, wanted.rms_torque)
    assert (found.peak_power, found.fluctuation) == (wanted.peak_power, wanted.fluctuation)
    rocking = Session(ROCKING, "rocking").view
    assert rocking is not None
    assert drive_sizing(rocking.circuit.forces()) is None


def test_the_arrow_is_the_force_or_the_part_of_it_that_is_determined() -> None:
    press = sb.load("rssr_press").motion(360).circuits[0].forces().reactions["ball_b"]
    np.testing.assert_array_equal(known_force(press), press.force_in_report)
    crank = sb.load("engine").motion(360).circuits[0].forces().reactions["crank"]
    assert not crank.determinate[3:].all()
    np.testing.assert_allclose(
        np.linalg.norm(known_force(crank), axis=1), np.linalg.norm(crank.force[:, :2], axis=1), rtol=1e-12
    )


def pink(colours: Floats) -> Any:
    """The pixels of the arrows of forces, which no link, path or point has."""
    red, green, blue = np.moveaxis(colours.astype(float), -1, 0)
    return (red > 120) & (green < 0.45 * red) & (blue > 1.2 * green) & (blue < 0.8 * red)


def test_forces_are_seen_switched_and_told_on_the_page(studio: Any, pages: Any) -> None:
    one = studio("rssr_press")
    desk = Desk("rssr_press", pages(one.url), one)
    page = desk.page
    desk.type("go to input", "340")
    choose(page, "curve 1", "input torque")
    choose(page, "curve 2", "power")
    choose(page, "curve 3", "ball_b force")
    open_tab(page, "Forces")
    sizing = desk.linkage.motion(360).circuits[0].forces().sizing()
    peak = f"peak {sizing.peak_torque.value:.4g} N m @ {math.degrees(sizing.peak_torque.input):.3f}°"
    desk.until(lambda: desk.verdict().get("input torque"), peak)
    # all tabs stand side by side in the narrowest panel
    names = ("Shape", "Show", "Points", "Forces", "Files")
    tabs = [page.get_by_role("tab", name=name, exact=True) for name in names]
    assert len({tab.bounding_box()["y"] for tab in tabs}) == 1
    before = settled(page)
    choose(page, "force arrows", "all joints")
    desk.wait(SHOWN)
    arrows = settled(page)
    drawn = pink(arrows) & (arrows != before).any(axis=2)
    assert drawn.sum() > 150
    keep(page, "forces_press")
    # the load of the work is off: the torque falls to what weights and inertia need
    assert not toggle(page, "work")
    light = desk.linkage.loaded(loads=[]).motion(360).circuits[0].forces().sizing().peak_torque.value
    desk.until(lambda: desk.verdict().get("input torque", "").startswith(f"peak {light:.4g} N m"), True)
    open_tab(page, "Files")
    choose(page, "gallery", next(o for o in options(page, "gallery") if o.startswith("rssr:")))
    open_tab(page, "Forces")
    desk.says(re.compile(r"\[\[body\]\]"))
    assert shown(page, "force arrows") == "none"
    assert shown(page, "curve 1").endswith("(output)")
    assert not pink(settled(page)).sum() > 20
