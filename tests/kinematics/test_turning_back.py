"""An input that turns back on the way and yet gains a turn with every round: a crank, as where it is the output."""

import json
import math

import numpy as np
import pytest

import adams_reader
import sevenbar as sb
from evidence.rewritten.drawing import Drawing
from evidence.rewritten.families import lattice
from evidence.rewritten.ways import from_another_joint, from_the_other_end, mirrored
from sevenbar.drawing.figure import note
from sevenbar.drawing.plot import configuration, curves, joints
from sevenbar.errors import RequestError
from sevenbar.export import pose
from sevenbar.export.adams import write_cmd
from sevenbar.export.layout import arrange
from sevenbar.kinematics.circuits.poses import walk
from sevenbar.kinematics.loop.law import Law
from sevenbar.kinematics.measures import MEASURES, rows_of
from sevenbar.kinematics.solvers.batches import loop_motions
from sevenbar.reporting import report
from sevenbar.reporting.summary import summary
from sevenbar.simulation.course import course

#: Places in a list of random loops with such circuits, of 2 to 10 dead centres on the way.
WITH_SUCH = (7, 9, 13, 24, 45, 52)


def loop(index: int) -> sb.Linkage:
    """A 7R with two digits to each number."""
    random = np.random.default_rng([5, index])
    return sb.from_dh(
        "R" * 7,
        length=random.uniform(0.3, 1.5, 7).round(2),
        twist=random.uniform(-math.pi, math.pi, 7).round(2),
        offset=random.uniform(-0.5, 0.5, 7).round(2),
    )


def moved(index: int, samples: int = 90, **asked: object) -> sb.Motion:
    return loop(index).motion(samples, **({"input": "theta_1", "output": "theta_4"} | asked))


def such(motion: sb.Motion) -> list[sb.Circuit]:
    return [circuit for circuit in motion if circuit.input_range is None and circuit.turns_back]


def apart(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """How far joint values are apart [rad], the greatest of all joints."""
    return np.abs((a - b + math.pi) % math.tau - math.pi).max(axis=-1)


def dead_inputs(circuit: sb.Circuit) -> np.ndarray:
    return np.array([d.input for d in circuit.dead_centres if d.kind == "input"])


@pytest.mark.parametrize("index", WITH_SUCH)
def test_a_motion_has_one_word_whichever_joint_drives(index):
    linkage = loop(index)
    motion = moved(index)
    back = linkage.motion(90, input="theta_4", output="theta_1")
    assert len(motion.circuits) == len(back.circuits)
    assert such(motion)
    for circuit in motion:
        place = circuit.q[circuit.status == "ok"][7]
        # the same circuit passes there with the other joint as its input
        again = linkage.circuit(place, 90, input="theta_4", output="theta_1")
        first, second = _words(circuit)
        assert _words(again) == (second, first)
        assert (again.output_range is None) == (circuit.input_range is None)
        assert (again.input_range is None) == (circuit.output_range is None)
        if circuit.input_range is not None:
            assert again.output_range == pytest.approx(
                np.array(circuit.input_range)
                + math.tau * round((again.output_range[0] - circuit.input_range[0]) / math.tau),
                abs=1e-9,
            )
        for kind, other in (("input", "output"), ("output", "input")):
            ends = sorted(d.input % math.tau for d in circuit.dead_centres if d.kind == kind)
            met = sorted(d.output % math.tau for d in again.dead_centres if d.kind == other)
            assert ends == pytest.approx(met, abs=1e-7)
    assert sorted(map(_words, motion)) == sorted(_words(circuit)[::-1] for circuit in back)


def _words(circuit: sb.Circuit) -> tuple[str, str]:
    """What the input and what the output is called."""
    first, second = circuit.motion_type.split("-")
    return (second, second) if first == "double" else (first, second)


@pytest.mark.parametrize("index", WITH_SUCH)
def test_its_rows_go_from_dead_centre_to_dead_centre_and_gain_the_turns(index):
    motion = moved(index)
    for circuit in such(motion):
        assert _words(circuit)[0] == "crank"
        assert circuit.closed
        assert not circuit.goes_round
        ends = dead_inputs(circuit)
        assert len(ends) % 2 == 0
        rows = np.flatnonzero(circuit.status == "dead-centre")
        assert circuit.input[rows] == pytest.approx(ends, abs=1e-12)
        assert rows[0] == 0
        assert (np.diff(circuit.branch) >= 0).all()
        # up, back, up .. on the passes, and whole turns on in the end
        gained = math.tau * circuit.turns
        places = np.append(ends, ends[0] + gained)
        assert (np.sign(np.diff(places)) == np.tile([1, -1], len(ends) // 2)).all()
        for branch in range(len(ends)):
            own = circuit.input[circuit.branch == branch]
            assert (np.sign(np.diff(own)) == np.sign(places[branch + 1] - places[branch])).all()
            assert circuit.pass_range(branch) == pytest.approx(sorted(places[branch : branch + 2]), abs=1e-12)
        path = walk(circuit)
        assert path.input[-1] == pytest.approx(path.input[0] + gained, abs=1e-12)
        assert path.ways == tuple([1.0, -1.0] * (len(ends) // 2))
        assert circuit.velocity is circuit.acceleration is circuit.jerk is circuit.time_ratio is None


@pytest.mark.parametrize("index", WITH_SUCH)
def test_every_mode_on_such_a_circuit_is_one_of_its_rows(index):
    samples = 24
    motion = moved(index, samples)
    rows = [circuit.q[np.isfinite(circuit.q).all(axis=1)] for circuit in motion]
    for k in range(samples):
        theta = math.tau * k / samples
        modes = loop(index).assembly_modes(theta, input="theta_1").q
        met = np.zeros(len(motion.circuits), dtype=int)
        for mode in modes:
            near = [apart(own, mode).min() for own in rows]
            assert min(near) < 1e-8
            met[int(np.argmin(near))] += 1
        # a full turn meets an odd number more than it goes back
        for circuit, count in zip(motion, met, strict=True):
            if circuit.input_range is None:
                assert count % 2 == circuit.turns % 2
                assert count >= circuit.turns


@pytest.mark.parametrize("index", WITH_SUCH)
def test_a_law_reaches_every_place_of_its_passes(index):
    motion = moved(index, 24)
    for circuit in such(motion):
        asked = np.unique(circuit.input[circuit.status == "ok"].round(9))
        law = Law.of(np.arange(float(len(asked))), asked, 1.0, 0.0)
        again = moved(index, law=law).circuits[circuit.index]
        count = len(dead_inputs(circuit))
        assert len(again.q) == count * len(asked)
        reached = again.q[again.status == "ok"]
        for row in circuit.q[circuit.status == "ok"]:
            assert apart(reached, row).min() < 1e-6
        # of an input on two places of one pass that which was asked for
        for branch in range(count):
            own = again.branch == branch
            low, high = circuit.pass_range(branch)
            within = (asked > low + 1e-6) & (asked < high - 1e-6)
            assert again.input[own][within] == pytest.approx(asked[within], abs=1e-9)


@pytest.mark.parametrize("index", WITH_SUCH[:3])
def test_a_falling_input_turns_only_the_rates(index):
    motion, falling = moved(index, speed=2.0), moved(index, speed=-2.0)
    for circuit in such(motion):
        other = falling.circuits[circuit.index]
        assert other.q.tobytes() == circuit.q.tobytes()
        assert other.dq == pytest.approx(-circuit.dq, nan_ok=True)
        assert other.ddq == pytest.approx(circuit.ddq, nan_ok=True)
        assert walk(other).ways == tuple(-way for way in walk(circuit).ways)
        assert walk(other).input[-1] == pytest.approx(circuit.input[0] + math.tau * circuit.turns)


@pytest.mark.parametrize("index", WITH_SUCH[:3])
def test_a_circuit_begins_at_the_same_dead_centre_wherever_it_is_met(index):
    linkage = loop(index)
    for circuit in such(moved(index)):
        for row in np.flatnonzero(circuit.status == "ok")[::29]:
            again = linkage.circuit(circuit.q[row], 90, input="theta_1", output="theta_4")
            assert apart(again.q[0], circuit.q[0]) < 1e-9
            assert again.status.tolist() == circuit.status.tolist()
            assert again.input == pytest.approx(circuit.input, abs=1e-9)


def test_a_batch_says_the_same_of_it():
    linkages = [loop(index) for index in WITH_SUCH]
    columns = [linkages[0].columns.index(name) for name in ("theta_1", "theta_4")]
    many = loop_motions(linkages, *columns, 90, 2)
    assert many.clear.all()
    for place, index in enumerate(WITH_SUCH):
        motion = moved(index)
        assert many.types[place] == motion.motion_type
        told = np.flatnonzero(many.linkage == place)
        for row, wanted in zip(told, rows_of(motion, tuple(MEASURES.values())), strict=True):
            for measure in MEASURES.values():
                if measure.per == "linkage":
                    continue
                values, value = measure.batch(many), wanted[measure.name]
                if isinstance(value, str):
                    assert values[row] == value
                else:
                    assert values[row] == pytest.approx(
                        math.nan if value is None else value, rel=1e-6, nan_ok=True
                    )


@pytest.mark.parametrize("index", WITH_SUCH[:2])
def test_report_and_figures_say_that_it_turns_and_where_it_turns_back(index):
    motion = moved(index)
    told = json.loads(report.as_json(motion))
    for circuit in such(motion):
        own = told["circuits"][circuit.index]
        assert own["turns"] == circuit.turns >= 1
        assert own["input_range"] is None
        assert own["extremes"]["velocity"]["status"] == "unbounded"
        assert sum(d["kind"] == "input" for d in own["dead_centres"]) == len(dead_inputs(circuit))
    facts = [fact for _, fact in summary(motion).facts]
    words = facts + [cell for sheet in summary(motion).sheets for row in sheet.rows for cell in row]
    assert any("one turn" in word for word in words)
    assert any("no bound at limits" in word for word in words)
    for figure in (curves(motion), joints(motion), configuration(motion, such(motion)[0].index)):
        assert figure.axes
    assert "±" in note(motion, cut=False)


@pytest.mark.parametrize("index", WITH_SUCH[:2])
def test_other_programs_are_driven_within_one_pass(index, tmp_path):
    motion = moved(index, 360)
    for circuit in such(motion):
        low, high = circuit.pass_range(0)
        middle = pose.take(motion, circuit.index)
        assert middle.input == pytest.approx((low + high) / 2)
        modes = motion.linkage.assembly_modes(middle.input, input="theta_1").q
        assert apart(modes, middle.q).min() < 1e-9
        write_cmd(arrange(middle), tmp_path / "a.cmd")
        end = float(adams_reader.read((tmp_path / "a.cmd").read_text()).run["end_time"])
        assert 0 < end * abs(motion.speed) < high - middle.input
        try:
            run = course(motion, circuit.index)
        except RequestError as error:
            assert "rows to compare" in str(error)
        else:
            assert not run.closes
            assert len(set(circuit.branch[run.rows])) == 1


@pytest.mark.parametrize("index", WITH_SUCH[:3])
def test_velocities_along_a_walk_are_turned_where_the_input_goes_back(index):
    motion = moved(index)
    for circuit in such(motion):
        path = walk(circuit)
        assert walk(circuit) is path
        seen = path.velocities(circuit.dq)
        for way, part in zip(path.ways, path.passes, strict=True):
            inner = slice(part.start + 1, part.stop - 1)
            assert (path.sign[inner] == way).all()
            assert np.array_equal(seen[inner], way * circuit.dq[path.rows[inner]], equal_nan=True)
            rises = np.diff(path.input[part])
            assert (np.sign(rises[np.abs(rises) > 1e-9]) == way * math.copysign(1, motion.speed)).all()


def written_anew(drawing: Drawing) -> list[Drawing]:
    return [
        drawing,
        from_another_joint(drawing, 2),
        from_another_joint(drawing, 5),
        from_the_other_end(drawing),
        mirrored(drawing),
    ]


def round_and_round(drawing: Drawing) -> sb.Circuit:
    """The circuit of that loop on which input and output turn fully."""
    motion = drawing.linkage().motion(36, input="j1", output="j6")
    return next(circuit for circuit in motion if circuit.motion_type == "double-crank")


def test_two_dead_centres_within_a_step_are_found_however_the_loop_is_written():
    loop = lattice(156, seed=1)
    for one in written_anew(loop):
        circuit = round_and_round(one)
        found = [centre for centre in circuit.dead_centres if centre.kind == "output"]
        assert len(found) == 6
        first, second = (
            min(found, key=lambda centre: abs(centre.input % math.tau - near))
            for near in (1.88653632, 1.88782919)
        )
        # limits are known to the root of rounding, and these nearly are one
        assert first.input % math.tau == pytest.approx(1.88653632, abs=2e-8)
        assert second.input % math.tau == pytest.approx(1.88782919, abs=2e-8)
        assert second.output - first.output == pytest.approx(2.13e-8, abs=1e-10)
        # the output turns back between them, as exact rows beside have it
        beside = np.array([1.886, 1.8872, 1.8883])
        rows = one.linkage().circuit(
            circuit.q[0], input="j1", output="j6", law=Law.of(np.arange(3.0), beside, 1.0, 0.0)
        )
        turned = rows.q[:, circuit.output_column] - first.output
        here = np.abs((turned + math.pi) % math.tau - math.pi) < 1e-3
        ratio = (rows.dq[:, circuit.output_column] / rows.dq[:, circuit.input_column])[here]
        assert np.sign(ratio).tolist() == [-1, 1, -1]


def test_a_curve_that_bends_sharply_between_two_change_points_goes_on_beyond_them():
    for one in written_anew(lattice(156, seed=1)):
        motion = one.linkage().motion(36, input="j1", output="j6")
        assert len(motion.circuits) == 3
        assert all(circuit.closed for circuit in motion)
        assert len(motion.change_points) == 4
