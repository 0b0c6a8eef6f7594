"""What is pulled in the scene goes the way of the number boxes: one step a pull, refused like a typed value."""

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.description.gallery import loops, nets, text
from sevenbar.errors import DescriptionError
from sevenbar.studio.state.grips import grips
from sevenbar.studio.state.session import Session
from sevenbar.studio.state.sketch import beginning, drawn, kinds_of
from studio_sessions import opened

FOUR_BAR = drawn("Four", "mm", beginning(kinds_of("RRRR")))
SLIDER = drawn("Slider", "mm", beginning(kinds_of("RRRP")))


def of(session):
    return grips(session.draft, None if session.problem else session.view, session.row)


def values(session):
    return {d.name: d.value for d in session.draft.dimensions}


def test_a_drawn_linkage_has_a_grip_for_each_place_and_what_shares_a_place_moves_together():
    session = Session(SLIDER, "slider")
    found = of(session)
    assert [grip.at.tolist() for grip in found] == [[0, 0, 0], [0, 40, 0], [130, 0, 0]]
    assert list(found[2].places) == [("joint", 2, "at"), ("joint", 3, "at")]
    session.move(found[2].dragged(np.array([150.0, 5.0, 0.0]), 100.0), object())
    assert [of(session)[2].at.tolist(), len(of(session)), len(session.past)] == [[150, 5, 0], 3, 1]
    # coupler hypot(150, 35) with the crank of 40 goes round
    assert session.motion.motion_type == "crank-slider"


def test_a_pull_is_one_step_however_long_and_the_next_one_is_another(monkeypatch):
    session = Session(FOUR_BAR, "four")
    now = [0.0]
    monkeypatch.setattr("sevenbar.studio.state.session.time.monotonic", lambda: now[0])
    first, second = object(), object()
    for stroke, ends in ((first, (101, 102, 103)), (second, (104, 105))):
        for x in ends:
            now[0] += 60.0
            session.move({("joint", 2, "at"): [x, 80, 0]}, stroke)
    assert len(session.past) == 2
    session.undo()
    assert values(session)["b.x"] == 103
    session.undo()
    assert values(session)["b.x"] == 100
    session.redo()
    assert values(session)["b.x"] == 103
    # a typed value in between begins another step, of the stroke too
    session.move({("joint", 2, "at"): [110, 80, 0]}, first)
    session.change(("joint", 0, "at"), [0, 1, 0])
    session.move({("joint", 2, "at"): [111, 80, 0]}, first)
    assert len(session.past) == 4


def test_what_goes_nowhere_is_no_step():
    session = Session(FOUR_BAR, "four")
    grip = of(session)[1]
    session.move(grip.dragged(grip.at + 0.01, 200.0), object())
    assert session.past == []


def test_coordinates_are_rounded_as_people_write_them_and_those_that_stay_stay():
    session = Session(FOUR_BAR.replace("[100, 80, 0]", "[100.123456, 80, 0]"), "four")
    grip = of(session)[2]

    def dragged(to, size):
        (value,) = grip.dragged(np.array(to), size).values()
        return value

    assert dragged([100.1234, 83.4567, 1e-6], 100.0) == [100.123456, 83.5, 0.0]
    assert dragged([99.0, 80.0, 0.0], 10_000.0) == [100.123456, 80.0, 0.0]
    assert dragged([64.0, 80.0, 0.0], 10_000.0) == [60.0, 80.0, 0.0]
    assert dragged([100.12399, 80.0, 0.0], 0.02) == [100.12399, 80.0, 0.0]


def test_a_place_that_is_refused_changes_nothing():
    session = Session(SLIDER.replace('kind = "R"\nat = [0, 40, 0]\naxis = [0, 0, 1]', 'kind = "S"\nat = [0, 40, 0]')
                      .replace('kind = "R"\nat = [130, 0, 0]\naxis = [0, 0, 1]', 'kind = "S"\nat = [130, 0, 0]'), "s")  # fmt: skip
    before = session.draft
    with pytest.raises(DescriptionError):
        # two balls in one place
        session.move({("joint", 1, "at"): [130, 0, 0]}, object())
    assert session.draft is before
    assert session.past == []


@pytest.mark.parametrize(
    "name", [name for name in (*loops(), *nets()) if "[[joint]]" in text(name) or "[[pin]]" in text(name)]
)
def test_a_drawn_linkage_is_found_as_it_is_drawn(name):
    session = opened(name)
    assert session.view is not None
    session.next_mode()
    session.step(40)
    session.as_drawn()
    kept = [i for i, c in enumerate(session.draft.linkage.columns) if c in session.draft.linkage.drivable()]
    q = session.view.joints(session.row)[kept]
    assert np.abs(np.remainder(q + np.pi, 2 * np.pi) - np.pi).max() < 1e-5


@pytest.mark.parametrize("name", ["rssr", "seven_r"])
@pytest.mark.parametrize("row", [0.0, 77.0, 200.5])
def test_a_named_point_of_another_form_is_gripped_where_it_is_drawn_and_goes_where_it_is_pulled(name, row):
    session = opened(name)
    session.add_point("mine", 2, (30.0, -20.0, 10.0))
    session.add_point("still", len(session.draft.linkage.joints), (1.0, 2.0, 3.0))
    session.row = row
    view = session.view
    frame = view.frame
    found = of(session)
    assert len(found) == len(session.draft.raw["point"])
    for grip in found:
        index = [p.name for p in view.linkage.points].index(
            session.draft.raw["point"][next(iter(grip.places))[1]]["name"]
        )
        place = frame.points[index - (len(view.linkage.points) - len(frame.points))]
        # between two rows the scene goes along the straight line
        within = 1e-9 if row == int(row) else 1e-3
        assert np.abs(frame.pose(row)[place] - grip.at).max() < within * frame.span
    mine = found[-2]
    to = mine.at + np.array([11.0, -7.0, 5.0])
    session.move(mine.dragged(to, frame.span), object())
    after = of(session)[-2]
    assert np.abs(after.at - to).max() < 1.0
    assert len(session.past) == 3


def test_a_linkage_that_does_not_move_keeps_its_grips_so_that_it_can_be_mended():
    session = Session(drawn("Rigid", "mm", beginning(kinds_of("RRR"))), "rigid")
    assert session.problem
    assert session.view is None
    assert len(of(session)) == 3
    rssr = Session(text("rssr").replace("D = 0", "D = 0\nL2 = 5000"), "far")
    assert of(rssr) == []


@pytest.mark.parametrize("name", nets())
def test_every_number_of_a_net_is_a_dimension_and_each_place_a_grip(name):
    session = opened(name)
    draft = session.draft
    assert len({d.name for d in draft.dimensions}) == len(draft.dimensions)
    coordinates = sum(
        np.size(table["at"]) for head in ("pin", "joint", "rod", "point") for table in draft.raw.get(head, ())
    )
    assert sum("at" in d.place for d in draft.dimensions) == coordinates
    assert sum(sum(grip.places.values()) for grip in of(session)) == coordinates
    for dimension in draft.dimensions:
        changed = draft.with_values({dimension.name: dimension.value + 0.25})
        assert {
            d.name: d.value - e.value
            for d, e in zip(changed.dimensions, draft.dimensions, strict=True)
            if d != e
        } == {dimension.name: pytest.approx(0.25)}
        assert changed.dimension(dimension.key).value == pytest.approx(dimension.value + 0.25)


def test_a_pin_of_a_net_and_what_lies_on_it_are_pulled_together_within_the_plane():
    session = opened("klann")
    session.add_point("mine", 1, (0.0, 0.0, 0.0))
    first = of(session)[0]
    at = first.at.tolist()
    session.draft = session.draft.with_value(("point", len(session.draft.raw["point"]) - 1, "at"), at)
    grip = of(session)[0]
    assert sorted(grip.places.values()) == [2, 3]
    session.move(grip.dragged(np.add(grip.at, [0.5, 0.2, 0.0]), 100.0), object())
    assert of(session)[0].at[:2] == pytest.approx(np.add(at, [0.5, 0.2, 0.0])[:2])
    assert session.problem == ""
    session.undo()
    assert of(session)[0].at == pytest.approx(at)


def test_a_net_that_is_pulled_moves_as_one_that_is_drawn_so():
    session = opened("watt")
    before = session.motion
    session.move({("pin", 5, "at"): [230, 65]}, object())
    raw = dict(sb.load("watt").description)
    raw["pin"] = [dict(pin) for pin in raw["pin"]]
    raw["pin"][5]["at"] = [230, 65]
    other = sb.from_pins(raw["pin"], ground="frame", drive="crank").motion(output="lever")
    assert session.motion.circuits[0].output_range == pytest.approx(other.circuits[0].output_range, abs=1e-9)
    assert session.motion.circuits[0].output_range != pytest.approx(before.circuits[0].output_range, abs=1e-3)
    assert "at = [230, 65]" in session.draft.toml()


def test_a_slide_as_drawn_reads_nothing_and_not_its_rounding():
    session = opened("five_rod")
    session.as_drawn()
    assert session.view.input_text(session.row) == "0 mm"
