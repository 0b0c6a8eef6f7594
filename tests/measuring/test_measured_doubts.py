"""What a calibration does not claim: no number without data for it, no file that is not what it says."""

import io
import math
import re
from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest
from rich.console import Console

import sevenbar as sb
from command_runs import mistake, sevenbar
from evidence.fuzz.random_linkages import Dimensions
from places import ROOT
from sevenbar.description.gallery import text
from sevenbar.errors import RequestError
from sevenbar.kinematics.loop.geometry import following_coupler
from sevenbar.kinematics.numbers.least_squares import nearest_least
from sevenbar.measuring.calibrate import calibrate
from sevenbar.measuring.compare import compare, ends_of
from sevenbar.measuring.figures import calibration_figure
from sevenbar.measuring.measured import Measured
from sevenbar.measuring.passes import stretches_of, ways_through
from sevenbar.measuring.report import calibration_page
from sevenbar.measuring.rewrite import calibrated_toml

PAPER = Dimensions(700.0, 700.0, 250.0, 550.0, 0.0, math.sqrt(450**2 + 550**2 + 700**2))
REAL = replace(PAPER, L1=251.0, L3=548.0)


def table(**values):
    count = len(next(iter(values.values())))
    return Measured(
        "bench.csv", np.arange(2, count + 2), {k: np.asarray(v, float) for k, v in values.items()}
    )


def curve(dims=REAL, count=90, noise=1e-4, seed=0):
    inputs = 2 * np.pi / count * np.arange(count)
    return inputs, dims.reference().outputs(inputs)[0] + noise * np.random.default_rng(seed).normal(
        size=count
    )


def rocking(dims=REAL, count=90, noise=1e-4, cycles=1):
    """The rocker drives: inputs up to one limit and back to the other, by the closure alone, in order."""
    reference = dims.reference()
    limits = sorted(reference.limits("rocker"))
    spans = zip(limits, [*limits[1:], limits[0] + 2 * math.pi], strict=True)
    low, high = next(
        s for s in spans if np.isfinite(reference.outputs(np.array([sum(s) / 2]), "rocker")).all()
    )
    share = (1 - np.cos(np.pi * (np.arange(count) + 0.5) / count)) / 2
    up = low + (high - low) * share
    ways = reference.outputs(up, "rocker")
    inputs = np.tile(np.concatenate([up, up[::-1]]), cycles)
    outputs = np.tile(np.concatenate([ways[0], ways[1][::-1]]), cycles)
    rng = np.random.default_rng(1)
    return inputs, np.unwrap(outputs) + noise * rng.normal(size=len(inputs))


def page(found):
    out = io.StringIO()
    Console(width=200, file=out).print(calibration_page(found))
    return out.getvalue()


# rows across a dead centre of the input


@pytest.mark.parametrize("cycles", [1, 2])
def test_rows_that_turn_back_at_a_limit_of_the_input_are_taken_pass_by_pass(cycles):
    inputs, angle = rocking(cycles=cycles)
    linkage = sb.load("rssr")
    ends = ends_of(linkage, "rocker")
    compared = compare(linkage, table(input=inputs, angle=angle), ends)
    assert len(compared.chosen.branches) == 2 * cycles
    assert set(compared.chosen.branches) == {0, 1}
    assert compared.chosen.explains
    # the turns are rows of the file
    turns = 90 * np.arange(1, 2 * cycles) + 1
    note = f"the input turns back at its limit in line{'s' * (cycles > 1)} {', '.join(map(str, turns))}: "
    assert any(n.startswith(note) for n in compared.notes)
    found = calibrate(linkage, table(input=inputs, angle=angle), ends, free=["L1", "L3"])
    assert any(n.startswith(note) for n in found.notes)
    for name in ("L1", "L3"):
        parameter = found.parameter(name)
        assert abs(parameter.value - getattr(REAL, name)) < 4 * parameter.error < 0.1
    assert found.noise["angle"] == pytest.approx(1e-4, rel=0.2)


@pytest.mark.parametrize("change", [(3.0, -6.0), (10.0, -15.0), (-10.0, 15.0)])
def test_limits_that_lie_elsewhere_than_in_the_design_do_not_spoil_the_fit(change):
    real = replace(PAPER, L1=250.0 + change[0], L3=550.0 + change[1])
    inputs, angle = rocking(real, noise=1e-3)
    linkage = sb.load("rssr")
    found = calibrate(
        linkage, table(input=inputs, angle=angle), ends_of(linkage, "rocker"), free=["L1", "L3"]
    )
    for name in ("L1", "L3"):
        parameter = found.parameter(name)
        assert abs(parameter.value - getattr(real, name)) < 4 * parameter.error < 0.2
    # those beyond the design's limits are left out
    assert len(found.line) > 130


def test_velocities_of_an_input_that_goes_back_have_the_other_sign():
    linkage = sb.load("rssr")
    ends = ends_of(linkage, "rocker")
    circuit = REAL.linkage().motion(90, input="rocker").circuits[0]
    ok = circuit.status == "ok"
    inputs, angle, rate = circuit.input[ok], circuit.output[ok], circuit.dq[ok, circuit.output_column]
    back = np.where(circuit.branch[ok] == circuit.branch[ok][0], 1.0, -1.0)
    up = 1.0 if inputs[1] > inputs[0] else -1.0
    for signed, velocity in ((True, up * back * rate), (False, rate)):
        measured = table(input=inputs, angle=angle, velocity=velocity)
        compared = compare(linkage, measured, ends, speed=1.0)
        assert compared.chosen.signed is signed
        found = calibrate(linkage, measured, ends, free=["L1", "L3"], speed=1.0)
        assert found.parameter("L1").value == pytest.approx(251.0, rel=1e-9)


def test_curves_of_several_passes_are_drawn_pass_by_pass():
    inputs, angle = rocking(cycles=2)
    linkage = sb.load("rssr")
    ends = ends_of(linkage, "rocker")
    compared = compare(linkage, table(input=inputs, angle=angle), ends)
    gaps = np.flatnonzero(np.isnan(compared.curve["input"]))
    assert len(gaps) == 3
    for stretch, part in enumerate(np.split(np.arange(len(compared.curve["input"])), gaps)):
        # beyond the nominal limits there is no curve, and next to them it is steep
        rows = np.flatnonzero((compared.stretch == stretch) & np.isfinite(compared.computed["angle"]))[5:-5]
        known = part[np.isfinite(compared.curve["angle"][part])]
        at = np.interp(inputs[rows], compared.curve["input"][known], compared.curve["angle"][known])
        np.testing.assert_allclose(at, compared.computed["angle"][rows], atol=1e-3)
    found = calibrate(linkage, table(input=inputs, angle=angle), ends, free=["L1", "L3"])
    top = calibration_figure(found).axes[0]
    for line in top.lines[:2]:
        x, y = line.get_xdata(), line.get_ydata()
        assert np.isnan(y).sum() == 3
        # degrees from one row to the next, within a pass
        assert np.nanmax(np.abs(np.diff(y))) < 30
        assert np.nanmin(np.diff(x)[np.isfinite(np.diff(y))]) >= 0


def test_a_crank_that_is_moved_to_and_fro_stays_on_its_pass():
    inputs = np.concatenate([np.linspace(0, 2, 40), np.linspace(2, 0.5, 30), np.linspace(0.5, 3, 40)])
    measured = table(input=inputs, angle=REAL.reference().outputs(inputs)[0])
    found = calibrate(sb.load("rssr"), measured, free=["L1", "L3"])
    assert found.before.chosen.branches == ()
    assert found.parameter("L3").value == pytest.approx(548.0, rel=1e-9)


def test_stretches_ignore_noise_of_the_input_and_ways_follow_the_circuit():
    travel = np.concatenate([np.linspace(0, 1, 50), np.linspace(1, 0.2, 40), np.linspace(0.2, 0.9, 35)])
    noisy = travel + 1e-3 * np.random.default_rng(0).normal(size=125)
    for inputs in (travel, noisy, travel + 2 * np.pi * 3, np.remainder(travel + 6.0, 2 * np.pi)):
        found = stretches_of(inputs, slides=False)
        assert found.rising == (True, False, True)
        assert np.abs(np.array(found.turns) - [49, 89]).max() <= 3
    # two passes: on at both limits, at the upper, at the lower; and each pass alone
    assert set(ways_through(found, 2)) == {(0,), (1,), (0, 1, 0), (1, 0, 1), (0, 1, 1), (1, 0, 0), (0, 0, 1), (1, 1, 0)}  # fmt: skip
    # four passes have a direction, which a turn before the limit reverses
    assert {(0, 1, 2), (0, 3, 2), (0, 1, 1), (0, 0, 3)} <= set(ways_through(found, 4))
    assert ways_through(found, 1) == [(0,)]
    shuffled = np.random.default_rng(1).permutation(travel)
    assert ways_through(stretches_of(shuffled, slides=False), 2) == [(0,), (1,)]


def test_rows_in_no_order_are_named_as_the_cause():
    inputs, angle = rocking()
    order = np.random.default_rng(2).permutation(len(inputs))
    measured = table(input=inputs[order], angle=angle[order])
    linkage = sb.load("rssr")
    with pytest.raises(RequestError, match=r"no circuit explains these data; .* sort them by time"):
        calibrate(linkage, measured, ends_of(linkage, "rocker"), free=["L1", "L3"])


# rows that no circuit explains


@pytest.mark.parametrize("free", ["*", "L?"])
def test_a_circuit_that_does_not_explain_the_rows_is_refused_with_the_one_that_does(free):
    inputs, angle = curve()
    with pytest.raises(RequestError) as caught:
        calibrate(sb.load("rssr"), table(input=inputs, angle=angle), free=[free], circuit=1)
    assert "circuit 1, branch 0, which was given, does not explain these data (residual 172 %" in str(
        caught.value
    )
    assert "; circuit 0, branch 0 does (0.271 %): leave --circuit and --branch out" in str(caught.value)


def test_a_branch_for_rows_of_two_passes_is_refused_with_the_way_that_explains_them():
    inputs, angle = rocking()
    linkage = sb.load("rssr")
    with pytest.raises(
        RequestError, match=r"branch 0, which was given, .* branches [01], [01] one after the other"
    ):
        calibrate(linkage, table(input=inputs, angle=angle), ends_of(linkage, "rocker"), branch=0)


@pytest.mark.parametrize("noise", [0.0, 1e-4])
def test_an_output_that_does_not_move_makes_no_linkage(noise):
    inputs = np.linspace(0.0, 6.0, 60)
    angle = 0.3 + noise * np.random.default_rng(0).normal(size=60)
    with pytest.raises(
        RequestError, match="is the same in all 60 rows" if noise == 0 else "no circuit explains"
    ):
        calibrate(sb.load("rssr"), table(input=inputs, angle=angle))


def test_a_length_never_becomes_zero_or_less():
    # a rocker that swings a fiftieth of what this crank makes it
    inputs = np.linspace(0.0, 6.2, 60)
    angle = 0.5 + 1e-9 * np.sin(inputs)
    with pytest.raises(RequestError) as caught:
        calibrate(sb.load("rssr"), table(input=inputs, angle=angle), free=["L1", "L2", "L3"])
    assert "no circuit explains" in str(caught.value) or "is no length any more" in str(caught.value)


def test_nothing_is_written_of_rows_that_no_circuit_explains(tmp_path):
    rows = "".join(f"{i / 10},{30 + i % 2}\n" for i in range(40))
    (tmp_path / "flat.csv").write_text("crank [rad],rocker [deg]\n" + rows)
    before = sorted(tmp_path.iterdir())
    message = mistake("calibrate", "rssr", "flat.csv", "--out", "out", cwd=tmp_path)
    assert "flat.csv: " in message
    assert sorted(tmp_path.iterdir()) == before


def test_the_file_is_read_again_and_explains_the_rows_as_the_calibration_does():
    inputs, angle = curve()
    found = calibrate(
        sb.load("rssr"), table(input=inputs, angle=angle), hold=["D"], offsets=["input", "output"]
    )
    linkage = sb.loads(calibrated_toml(text("rssr"), found))
    zero = found.parameter("output_offset").value
    again = compare(linkage, table(input=found.input, angle=angle - zero))
    rms = math.sqrt(np.mean((found.measured["angle"] - found.computed["angle"]) ** 2))
    assert again.spread("angle").rms == pytest.approx(rms, rel=1e-6)
    # a calibration that is not that of its file is noticed
    other = replace(found, parameters=tuple(
        replace(p, value=p.value + 1.0) if p.name == "L1" else p for p in found.parameters))  # fmt: skip
    with pytest.raises(RequestError, match="read again, does not explain"):
        calibrated_toml(text("rssr"), other)
    broken = replace(found, parameters=tuple(
        replace(p, value=-2e-16) if p.name == "L1" else p for p in found.parameters))  # fmt: skip
    with pytest.raises(RequestError, match=r"make no linkage, so nothing is written: .*L1"):
        calibrated_toml(text("rssr"), broken)


# rows far off, repeats, exact rows


@pytest.mark.parametrize("count", [12, 90])
@pytest.mark.parametrize("row", [0, 5, 8])
def test_a_row_of_100_times_the_median_residual_is_named_with_its_line(count, row):
    inputs, angle = curve(count=count)
    angle[row] += 100 * 0.67e-4
    linkage = sb.load("rssr")
    found = calibrate(linkage, table(input=inputs, angle=angle), free=["L1", "L3"])
    (note,) = [n for n in found.notes if "far off" in n]
    assert note.startswith(f"the angle is far off in bench.csv: line {row + 2} by 0.00")
    assert note.count("line ") == 1
    exact = REAL.linkage()
    compared = compare(exact, table(input=inputs, angle=angle))
    (note,) = [n for n in compared.notes if "far off" in n]
    assert f"line {row + 2} by 0.00" in note
    assert note.count("line ") == 1


def test_several_slips_do_not_hide_each_other():
    inputs, angle = curve()
    angle[[10, 11, 50]] += [0.02, 0.021, -0.03]
    found = calibrate(sb.load("rssr"), table(input=inputs, angle=angle), hold=["D"])
    (note,) = [n for n in found.notes if "far off" in n]
    assert [int(word.split()[0]) for word in note.split("line ")[1:]] == [52, 13, 12]


@pytest.mark.parametrize("seed", range(20))
def test_noise_alone_and_steep_curves_name_no_row(seed):
    inputs, angle = curve(seed=seed)
    linkage = sb.load("rssr")
    assert not any("far off" in n for n in calibrate(linkage, table(input=inputs, angle=angle)).notes)
    assert not any("far off" in n for n in compare(linkage, table(input=inputs, angle=angle)).notes)
    if seed < 4:
        inputs, angle = rocking(replace(PAPER, L1=250.0 + seed, L3=549.0))
        measured = table(input=inputs, angle=angle)
        assert not any("far off" in n for n in compare(linkage, measured, ends_of(linkage, "rocker")).notes)


def test_repeats_of_an_input_are_one_place():
    inputs = np.repeat([0.0, 0.7, 1.4, 2.1], 5)
    angle = REAL.reference().outputs(inputs)[0] + 1e-4 * np.random.default_rng(0).normal(size=20)
    with pytest.raises(RequestError) as caught:
        calibrate(sb.load("rssr"), table(input=inputs, angle=angle))
    assert "4 measured values at 4 places, as 16 rows repeat the input of another, cannot identify" in str(
        caught.value
    )


def test_copies_of_rows_change_no_interval_and_turns_later_are_the_same_place():
    inputs, angle = curve(count=30)
    once = calibrate(sb.load("rssr"), table(input=inputs, angle=angle), free=["L1", "L3"])
    for later in (0.0, 2 * np.pi):
        twice = table(input=np.concatenate([inputs, inputs + later]), angle=np.concatenate([angle, angle]))
        found = calibrate(sb.load("rssr"), twice, free=["L1", "L3"])
        assert (found.places, found.freedom, len(found.line)) == (30, once.freedom, 60)
        for a, b in zip(found.calibrated, once.calibrated, strict=True):
            assert a.value == pytest.approx(b.value, rel=1e-10)
            assert a.error == pytest.approx(b.error, rel=1e-6)
        assert "60 rows at 30 places of angle" in page(found)


def test_intervals_of_repeated_rows_hold_the_truth_as_often_as_they_claim():
    inputs = np.tile(np.linspace(0.0, 6.0, 15), 4)
    angle = REAL.reference().outputs(inputs)[0]
    rng, held = np.random.default_rng(5), 0
    for _ in range(200):
        measured = table(input=inputs, angle=angle + 1e-3 * rng.normal(size=60))
        parameter = calibrate(sb.load("rssr"), measured, free=["L1", "L3"]).parameter("L1")
        held += parameter.low <= 251.0 <= parameter.high
    # 1 % of doubt to each side of 95 % of 200
    assert 181 <= held <= 198


def test_exact_rows_of_the_design_itself_are_settled_at_once_whatever_is_free():
    linkage = sb.load("seven_r")
    circuit = linkage.motion(60).circuits[0]
    found = calibrate(linkage, table(input=circuit.input, angle=circuit.output))
    assert found.exact
    assert [p.value for p in found.parameters] == pytest.approx(
        [p.nominal for p in found.parameters], abs=1e-9
    )
    # three axes are parallel: lengths across them turn nothing, and of slides along them only the sum counts
    held = {p.name: set(p.undone_by) for p in found.parameters if p.status == "unidentified"}
    assert {name for name, others in held.items() if not others} == {f"length_{i}" for i in range(2, 6)}
    assert held["offset_3"] == held["offset_4"] == {"offset_5"}


def test_exact_rows_have_no_warning_and_no_interval():
    inputs, angle = curve(noise=0.0)
    found = calibrate(sb.load("rssr"), table(input=inputs, angle=angle), hold=["D"])
    assert found.exact
    assert [note for note in found.notes if "exact" not in note] == []
    for parameter in found.calibrated:
        assert math.isnan(parameter.error)
        assert math.isnan(parameter.low)
    (line,) = [line for line in page(found).splitlines() if line.startswith("L1 [mm]")]
    assert line.split()[-4:] == ["250", "251.000000", "exact", "+1.000000"]
    assert "Exact rows: no intervals." in calibrated_toml(text("rssr"), found)
    assert compare(REAL.linkage(), table(input=inputs, angle=angle)).notes == ()


# a coupler that the file leaves out


def test_a_coupler_that_the_file_leaves_out_is_a_rod_of_its_own_unless_it_is_to_follow():
    linkage = sb.load("rssr")
    inputs, angle = curve()
    held = calibrate(linkage, table(input=inputs, angle=angle), free=["L1", "L3"])
    assert held.parameter("L2").status == "fixed"
    assert held.parameter("L2").value == linkage.dimensions["L2"]
    assert "held              M, N, D, L2 (997.497 mm in the design)" in page(held)
    assert calibration_page(held).facts.as_dict["left_out"] == ["L2"]
    found = calibrate(linkage, table(input=inputs, angle=angle), free=["L1", "L2", "L3"], hold=["D"])
    assert found.parameter("L2").status == "calibrated"
    real = replace(REAL, L2=float(following_coupler(700.0, 700.0, 251.0, 548.0)))
    inputs, angle = curve(real, noise=1e-5)
    follows = calibrate(linkage, table(input=inputs, angle=angle), free=["L1", "L3"], follow=["L2"])
    values = {p.name: p.value for p in follows.parameters}
    assert values["L2"] == float(following_coupler(values["M"], values["N"], values["L1"], values["L3"]))
    for name in ("L1", "L2", "L3"):
        parameter = follows.parameter(name)
        assert abs(parameter.value - getattr(real, name)) < 4 * parameter.error < 0.1
    assert follows.parameter("L2").status == "follows"
    assert "held              M, N, D; L2 follows (997.497 mm in the design)" in page(follows)
    written = calibrated_toml(text("rssr"), follows)
    assert not any(line.startswith("L2") for line in written.splitlines())
    assert sb.loads(written).dimensions["L2"] == values["L2"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"follow": ["L2"], "free": ["L1", "L2"]}, "follow: L2 is in --free too; give it in one of them"),
        ({"follow": ["L2"], "hold": ["L2"]}, "follow: L2 is in --hold too; give it in one of them"),
        ({"follow": ["L1"]}, "follow: 'L1' is given, 250 mm, so it stays; give L2"),
        ({"follow": ["x"]}, "follow: 'x' is not a dimension; give L2"),
    ],
)
def test_what_cannot_follow_is_refused(options, message):
    inputs, angle = curve(count=12)
    with pytest.raises(RequestError) as caught:
        calibrate(sb.load("rssr"), table(input=inputs, angle=angle), **options)
    assert str(caught.value) == message


def test_the_refusal_on_the_page_is_that_of_the_command():
    root = ROOT
    page = (root / "docs" / "measured.md").read_text(encoding="utf-8")
    command, said = re.search(r"`sevenbar (calibrate .*--circuit 1)`:\n\n    (sevenbar: .*)\n", page).groups()
    run = sevenbar(*command.split(), cwd=root)
    assert (run.returncode, run.stdout) == (2, "")
    assert run.stderr.splitlines()[-1] == said


# the minimum


def paper_output(alpha, m, n, crank, coupler, rocker, d):
    """Sun and Zhou, eq. (8), in as many digits as mpmath has."""
    y = crank * mp.sin(alpha) - d
    k = (crank**2 + m**2 + d**2 + rocker**2 + n**2 - coupler**2) / 2 - crank * (
        m * mp.cos(alpha) + d * mp.sin(alpha)
    )
    return mp.asin(k / (rocker * mp.hypot(n, y))) - mp.atan2(y, n)


def test_the_gradient_at_the_calibrated_dimensions_is_zero_in_40_digits():
    inputs, angle = curve(replace(REAL, D=2.0), count=60, noise=1e-3)
    linkage = sb.load("rssr")
    found = calibrate(linkage, table(input=inputs, angle=angle))
    names = [p.name for p in found.calibrated]
    with mp.workdps(40):
        at = {name: mp.mpf(float(found.parameter(name).value)) for name in ("M", "N", "L1", "L2", "L3", "D")}

        def residual(**changed):
            return [
                paper_output(mp.mpf(x), *(at | changed).values()) - mp.mpf(y)
                for x, y in zip(inputs, angle, strict=False)
            ]

        step = mp.mpf(10) ** -12
        here = residual()
        slopes = [
            [
                (a - b) / (2 * step)
                for a, b in zip(residual(**{k: at[k] + step}), residual(**{k: at[k] - step}), strict=False)
            ]
            for k in names
        ]
        normal = mp.matrix([[mp.fdot(a, b) for b in slopes] for a in slopes])
        left = mp.lu_solve(normal, -mp.matrix([mp.fdot(a, here) for a in slopes]))
        errors = {
            name: abs(float(way / max(abs(at[name]), 1))) for name, way in zip(names, left, strict=False)
        }
    assert set(names) >= {"L1", "L2", "L3", "D"}
    assert max(errors.values()) < 1e-10, errors


def test_least_squares_ends_at_the_minimum_from_afar_and_says_where_it_could_not():
    # Beale's function, least at (3, 0.5), and a fence across the way
    wanted = np.array([1.5, 2.25, 2.625])
    powers = np.arange(1, 4)

    def residual(x):
        return wanted - x[0] * (1 - x[1] ** powers)

    def jacobian(x):
        return np.column_stack([x[1] ** powers - 1, x[0] * powers * x[1] ** (powers - 1)])

    start, ways = np.array([1.0, 0.1]), {"evaluations": 200, "first": 1e-3}
    found = nearest_least(residual, jacobian, start, **ways)
    assert found.end == "settled"
    np.testing.assert_allclose(found.z, [3.0, 0.5], rtol=1e-12)
    fenced = nearest_least(lambda x: residual(x) if x[0] < 2.0 else None, jacobian, start, **ways)
    assert fenced.end == "closed"
    assert fenced.z[0] < 2.0
    assert nearest_least(residual, jacobian, start, evaluations=3, first=1e-3).end == "unsettled"


# long work


STOP = """
import importlib
def interrupted(*_, progress=None, **__):
    progress(0, 0)
    raise KeyboardInterrupt
importlib.import_module("sevenbar.measuring.calibrate").calibrate = interrupted
"""


def test_ctrl_c_leaves_nothing_and_says_so(tmp_path):
    inputs, angle = curve()
    rows = "".join(f"{x},{y}\n" for x, y in zip(inputs, angle, strict=True))
    (tmp_path / "bench.csv").write_text("crank [rad],rocker [rad]\n" + rows)
    run = sevenbar("calibrate", "rssr", "bench.csv", "--out", "out", cwd=tmp_path, before=STOP)
    assert (run.returncode, run.stdout) == (130, "")
    assert run.stderr == "calibrating RSSR of Sun and Zhou ..\nsevenbar: stopped; nothing is written\n"
    assert [path.name for path in tmp_path.iterdir()] == ["bench.csv"]


def test_progress_has_the_best_residual_so_far():
    seen = []
    inputs, angle = curve()
    found = calibrate(
        sb.load("rssr"), table(input=inputs, angle=angle), progress=lambda *now: seen.append(now)
    )
    assert seen[0] == (0, 0, "")
    assert [done for done, _, _ in seen] == sorted(done for done, _, _ in seen)
    shares = [float(best.split()[1]) for _, _, best in seen[1:]]
    assert shares == sorted(shares, reverse=True)
    assert shares[-1] == pytest.approx(
        100 * math.sqrt(np.mean((found.measured["angle"] - found.computed["angle"]) ** 2)) / np.ptp(angle),
        rel=0.01,
    )
