"""Laws from files: against the RSSR's closed formula, differences of rows, and the same law in other words."""

import sys

import mpmath as mp
import numpy as np
import pytest

import sevenbar as sb
from command_runs import sevenbar
from sevenbar.errors import MissingExtraError, RequestError, TableError

#: Sun and Zhou's linkage; its coupler is |A1 B1|.
M, N, L1, L3 = 700, 700, 250, 550
L2_SQUARED = (L1 - M) ** 2 + L3**2 + N**2


def course(t):
    """A crank angle [rad] that speeds up and slows down."""
    return mp.mpf("0.3") + 6 * t + mp.mpf("0.4") * mp.sin(3 * t)


def rocker(t):
    """Eq. (8) of the paper at that angle [rad]."""
    y = L1 * mp.sin(course(t))
    k = mp.mpf(L1**2 + M**2 + L3**2 + N**2 - L2_SQUARED) / 2 - L1 * M * mp.cos(course(t))
    return mp.asin(k / (L3 * mp.hypot(N, y))) - mp.atan2(y, N)


def derivatives(function, times, orders=4):
    with mp.workdps(40):
        return np.array([[float(mp.diff(function, mp.mpf(t), k)) for k in range(orders)] for t in times])


def write(path, heads, columns):
    rows = [",".join(f"{x:.17g}" for x in row) for row in zip(*columns, strict=True)]
    path.write_text("\n".join([heads, *rows]) + "\n")
    return path


def rssr():
    return sb.rssr(M, N, L1, L3, 0)


def driven(linkage, path, **ends):
    return linkage.motion(law=sb.load_law(path, linkage, input=ends.get("input")), **ends)


def of_branch_0(motion, first):
    (circuit,) = [c for c in motion.circuits if abs(c.output[0] - first) < 0.5]
    return circuit


def test_a_law_with_all_rates_gives_those_of_the_closed_formula(tmp_path):
    times = np.linspace(0, 1.2, 25) ** 1.1
    wanted = derivatives(rocker, times)
    given = derivatives(course, times)
    path = write(
        tmp_path / "law.csv",
        "t,angle [rad],speed [rad/s],acceleration [rad/s^2],jerk (rad/s³)",
        [times, *given.T],
    )
    circuit = of_branch_0(driven(rssr(), path), wanted[0, 0])
    assert circuit.time == pytest.approx(times, rel=1e-15)
    for order, rows in enumerate((circuit.q, circuit.dq, circuit.ddq, circuit.dddq)):
        assert rows[:, -1] == pytest.approx(wanted[:, order], rel=1e-11, abs=1e-11 * 20**order)


@pytest.mark.parametrize(
    ("heads", "count"),
    [
        ("time_s,crank_deg", 1),
        ("time_s,crank_deg,crank_deg_s", 2),
        ("time_s,crank_deg,crank_deg_s,crank_deg_s2", 3),
    ],
)
def test_rates_that_are_not_given_converge_with_the_rows_to_the_closed_formula(tmp_path, heads, count):
    errors = []
    for rows in (41, 81, 161):
        times = np.linspace(0, 1.2, rows)
        given = np.degrees(derivatives(course, times)[:, :count])
        path = write(tmp_path / "law.csv", heads, [times, *given.T])
        wanted = derivatives(rocker, times)
        circuit = of_branch_0(driven(rssr(), path), wanted[0, 0])
        found = [circuit.q, circuit.dq, circuit.ddq, circuit.dddq]
        errors.append([np.abs(f[:, -1] - w).max() for f, w in zip(found, wanted.T, strict=True)])
    # a spline of degree five through the highest given one: its k-th derivative is of order 6 - k
    for order in range(count, 4):
        steps = np.log2([errors[i][order] / errors[i + 1][order] for i in range(2)])
        assert steps.min() > 6 - (order - count + 1) - 0.7, (order, errors)
    assert errors[-1][2] < 1e-4
    assert errors[-1][0] < 1e-12


def test_rows_of_a_general_loop_change_from_row_to_row_as_their_rates_say(tmp_path):
    linkage = sb.load("rscr")
    step = 2e-3
    times = step * np.arange(301)
    angle = 0.2 + 3 * times + 0.3 * np.sin(5 * times)
    path = write(tmp_path / "law.csv", "time [ms],crank [rad]", [1000 * times, angle])
    passes = 0
    for circuit in driven(linkage, path):
        assert (circuit.status == "ok").all()
        # a circuit that rocks holds the law once for each pass
        for rows in np.split(np.arange(len(circuit.time)), len(circuit.time) // len(times)):
            passes += 1
            q, dq, ddq = circuit.q[rows], circuit.dq[rows], circuit.ddq[rows]
            first = (-q[4:] + 8 * q[3:-1] - 8 * q[1:-3] + q[:-4]) / (12 * step)
            second = (-q[4:] + 16 * q[3:-1] - 30 * q[2:-2] + 16 * q[1:-3] - q[:-4]) / (12 * step**2)
            # step^4 times derivatives that may be some hundred times these, and rounding over step^2
            assert (np.abs(first - dq[2:-2]).max(axis=0) < 1e-7 * np.abs(dq).max(axis=0)).all()
            assert (np.abs(second - ddq[2:-2]).max(axis=0) < 1e-6 * np.abs(ddq).max(axis=0)).all()
    assert passes == 4


def test_the_same_law_in_other_units_separators_and_order_is_the_same(tmp_path):
    linkage = rssr()
    times = np.linspace(0, 0.5, 9)
    given = derivatives(course, times)
    one = sb.load_law(
        write(tmp_path / "one.csv", "time [s],crank [rad],crank [rad/s]", [times, *given.T[:2]]), linkage
    )
    lines = ["# measured on the bench", "crank (rpm);Crank(°);remark;TIME (ms)"]
    lines += [
        f"{v * 60 / (2 * np.pi):.17g};{np.degrees(q):.17g};a, b;{1000 * t:.17g}"
        for t, (q, v) in zip(times, given[:, :2], strict=True)
    ]
    (tmp_path / "two.csv").write_text("\ufeff" + "\r\n".join(lines) + "\r\n\r\n", encoding="utf-8")
    two = sb.load_law(tmp_path / "two.csv", linkage)
    for name in ("t", "q", "dq", "ddq", "dddq"):
        values = getattr(one, name)
        assert getattr(two, name) == pytest.approx(values, rel=1e-12, abs=1e-9 * np.abs(values).max())


def rows(form, columns):
    return "".join(form.format(*row) for row in zip(*columns, strict=True))


def comma(text):
    return text.replace(".", ",")


@pytest.mark.parametrize(
    ("head", "form", "changed", "encoding"),
    [
        ("time [s];crank [deg]\n", "{:.12g};{:.17g}\n", comma, "utf-8"),
        ("t\tWinkel [°]\r\n", "{:.12g}\t{:.17g}\r\n", comma, "cp1252"),
        ("time [s],crank [deg]\n", "{:.12g},{:.17g}\n", str, "utf-16"),
        ("% time [s]   crank [deg]\n", "  {:.16e}   {:.16e}\n", str, "utf-8"),
        ("ADAMS run 3\n\n   Time    CRANK\n  (sec)    (deg)\n", "  {:.16E}   {:.16E}\n", str, "utf-8"),
        ("time [s],crank [deg]\n# as measured, by hand\n", "{:.12g},{:.17g}\n,\n", str, "utf-8"),
    ],
    ids=["decimal comma", "spreadsheet", "UTF-16", "MATLAB", "ADAMS", "remark and empty lines"],
)
def test_a_law_is_read_from_what_other_programs_write(tmp_path, head, form, changed, encoding):
    times = np.linspace(0, 0.5, 9)
    degrees = 200 * times**2 + 7 * times
    (tmp_path / "law.txt").write_bytes((head + changed(rows(form, [times, degrees]))).encode(encoding))
    law = sb.load_law(tmp_path / "law.txt", rssr())
    assert law.t == pytest.approx(times, abs=1e-12)
    assert law.q == pytest.approx(np.radians(degrees), rel=1e-15)
    assert law.ddq == pytest.approx(np.full(9, np.radians(400)), rel=1e-9)


def test_turns_in_a_law_are_counted_in_revolutions(tmp_path):
    path = write(
        tmp_path / "law.csv",
        "time_s,crank_rev,crank_rev_min",
        [[0, 1, 2, 3, 4, 5], np.arange(6) / 4, [15] * 6],
    )
    law = sb.load_law(path, rssr())
    assert law.q == pytest.approx(np.arange(6) * np.pi / 2, rel=1e-15)
    assert law.dq == pytest.approx(np.full(6, np.pi / 2), rel=1e-15)


def test_a_slide_is_driven_in_any_length_unit(tmp_path):
    linkage = sb.load("rssp")
    times = np.linspace(0, 1, 21)
    place = 30 * np.sin(2 * times)
    path = write(tmp_path / "law.csv", "time_s,slider_cm", [times, place / 10])
    law = sb.load_law(path, linkage, input="slider")
    assert law.q == pytest.approx(place, rel=1e-14)
    assert law.dq == pytest.approx(60 * np.cos(2 * times), abs=1e-4)


def test_a_table_that_sevenbar_wrote_drives_the_same_motion(tmp_path):
    motion = rssr().motion(samples=24, speed=10)
    circuit = motion.circuits[1]
    columns = {name: values[24:] for name, values in motion.columns().items()}
    rows = [",".join(map(str, row)) for row in zip(*columns.values(), strict=True)]
    (tmp_path / "motion.csv").write_text("\n".join([",".join(columns), *rows]))
    again = driven(rssr(), tmp_path / "motion.csv").circuits[1]
    assert again.q == pytest.approx(circuit.q, abs=1e-12)
    assert again.ddq == pytest.approx(circuit.ddq, abs=1e-9)


def table(head, *rows):
    return "\n".join([head, *rows]) + "\n"


HEAD = "time [s],crank [deg]"
NEEDED = "'time [s],crank [deg]'"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "is empty; give a table with a header and rows of numbers"),
        (
            "\n# nothing\n,,\n",
            "has text but no row of numbers; give a table with a header and rows of numbers",
        ),
        (HEAD, "has text but no row of numbers; give a table with a header and rows of numbers"),
        (table("0,1", "1,2"), f"no column for the time; the file has no header; name them as in {NEEDED}"),
        (
            table("crank [deg]", "1"),
            f"no column for the time; the columns are 'crank [deg]'; name them as in {NEEDED}",
        ),
        (
            table("time [s],crank", "0,1"),
            "no column with an angle of crank, which turns; the columns are 'time [s]', 'crank'; "
            f"name them as in {NEEDED}",
        ),
        (
            table("time [s],crank [mm]", "0,1"),
            "no column with an angle of crank, which turns; the columns are 'time [s]', 'crank [mm]'; "
            f"name them as in {NEEDED}",
        ),
        (
            table("time [s],a [deg],b [rad]", "0,1,2"),
            "line 1: 'a [deg]', 'b [rad]' may each be the angle; keep the one of the input, or name it 'crank' and its unit",
        ),
        (
            table("time [s],crank [deg],crank [rad/s^2]", "0,1,2"),
            "'crank [rad/s^2]' is given without a column of velocity; add that, or leave this out",
        ),
        (
            table(HEAD, "0,1", "0.1"),
            "line 3: 1 cell where line 2 has 2; the file is cut or damaged there, or holds a second table: mend it",
        ),
        (
            table("time [s],crank [deg]", "s,rad", "0,1"),
            "mixed units: column 'crank [deg]' has 'deg' in its name and 'rad' in the line of units; keep the right one",
        ),
        (
            table(HEAD, "0,1", "0.1,nan"),
            "line 3: no number in column 'crank [deg]' ('nan'); mend it, or leave such rows out",
        ),
        (
            table(HEAD, "0,1", "-inf,2"),
            "line 3: no number in column 'time [s]' ('-inf'); mend it, or leave such rows out",
        ),
        (
            table(HEAD, "0,1", "0.1,", "0.2,"),
            "lines 3, 4: no number in column 'crank [deg]' (''); mend them, or leave such rows out",
        ),
        (
            table(HEAD, "0,1", "0.1,1 deg"),
            "line 3, column 'crank [deg]': '1 deg' carries a unit of its own; write plain numbers, all in the one "
            "unit that the header names",
        ),
        (
            table("time [s];crank [deg]", "0.0;0,5"),
            "line 2, column 'crank [deg]': '0,5' is not a number; mend the cell or leave the row out",
        ),
        (
            table(HEAD, "0,1", "0.2,2", "0.1,3"),
            "line 4: time 0.1 after 0.2 in line 3; times must rise: sort the rows, and keep one run only",
        ),
        (
            table(HEAD, "0,1", "0.2,2", "", "0.2,3"),
            "line 5: time 0.2 again, as in line 3; times must rise: sort the rows, and keep one run only",
        ),
        (
            table(HEAD, *(f"{i},{i}" for i in range(5))),
            "5 rows are too few: a spline through each value needs 6; "
            "give more rows, or columns of velocity and acceleration and jerk",
        ),
        (
            table(HEAD, *(f"{i},{(100 * i) % 360}" for i in range(9))),
            "line 6, column 'crank [deg]': goes from 300 to 40 in one row, more than half a turn; "
            "let the angle count on past a full turn, and give rows that are nearer",
        ),
        (
            table("time [s],crank [deg],crank [rad/s]", *(f"{i},{10 * i},10" for i in range(9))),
            "column 'crank [rad/s]': is no velocity of 'crank [deg]': it makes for 57.3 times its changes; "
            "check both units",
        ),
        (
            table("time [s],crank [rad],crank [rad/s]", *(f"{i},3,1e300" for i in range(9))),
            "column 'crank [rad/s]': is no velocity of 'crank [rad]': those values rest; check both units",
        ),
    ],
)
def test_each_mistake_in_a_law_has_its_own_message(tmp_path, content, message):
    (tmp_path / "law.csv").write_text(content)
    with pytest.raises(TableError) as caught:
        sb.load_law(tmp_path / "law.csv", rssr())
    assert str(caught.value) == f"{tmp_path / 'law.csv'}: {message}"


def test_what_is_no_table_of_text_is_told_as_such(tmp_path):
    (tmp_path / "zeros.csv").write_bytes(bytes(5000))
    (tmp_path / "line.csv").write_text(HEAD + "," * 2_000_000)
    for name, message in (
        ("zeros.csv", "not a table of text (it holds bytes that no text has); export it as CSV or text"),
        ("line.csv", "line 1 has 2000020 characters, so it is no row of a table; export it as CSV"),
        ("none.csv", "no such file; give the path of a table of an input law"),
        (".", "is a folder; give the path of a table in it"),
    ):
        with pytest.raises(TableError) as caught:
            sb.load_law(tmp_path / name, rssr())
        assert str(caught.value) == f"{tmp_path / name}: {message}"


def test_a_ball_takes_no_law(tmp_path):
    path = write(tmp_path / "law.csv", HEAD, [range(9), range(9)])
    with pytest.raises(RequestError, match="input: joint 'ball_a' is a ball"):
        sb.load_law(path, rssr(), input="ball_a")


def test_without_scipy_only_what_needs_a_spline_is_refused(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "scipy", None)
    monkeypatch.setitem(sys.modules, "scipy.interpolate", None)
    whole = "time [s],q [rad],v [rad/s],a [rad/s2],j [rad/s3]"
    law = sb.load_law(write(tmp_path / "law.csv", whole, [[0, 1], [0, 1], [1, 1], [0, 0], [0, 0]]), rssr())
    assert law.t.tolist() == [0, 1]
    path = write(tmp_path / "law.csv", HEAD, [range(9), range(9)])
    with pytest.raises(MissingExtraError) as caught:
        sb.load_law(path, rssr())
    assert str(caught.value) == (
        f"{path}: a spline through each value needs SciPy; install it with: pip install 'sevenbar[law]', "
        "or give columns of velocity and acceleration and jerk"
    )


def test_the_command_line_takes_a_law_and_writes_its_rows(tmp_path):
    times = np.linspace(0, 1, 21)
    write(tmp_path / "law.csv", HEAD, [times, 100 * times + 20 * np.sin(4 * times)])
    run = sevenbar("analyze", "rssr", "--law", "law.csv", "--out", "out", cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    assert "crank by a law, output rocker" in run.stdout
    assert "21 rows from 0 s to 1 s" in run.stdout
    lines = (tmp_path / "out" / "motion.csv").read_text().splitlines()
    assert len(lines) == 1 + 2 * 21
    first = dict(zip(lines[0].split(","), lines[11].split(","), strict=True))
    assert float(first["time_s"]) == 0.5
    assert float(first["crank_deg"]) == pytest.approx(50 + 20 * np.sin(2), rel=1e-14)
    assert float(first["crank_rad_s"]) == pytest.approx(np.radians(100 + 80 * np.cos(2)), rel=1e-5)


@pytest.mark.parametrize(
    ("linkage", "joint", "unit", "first", "last", "posed"),
    [
        # circuit 0 is within 111 to 187 deg, circuit 1 within -7 to 68
        ("rssr", "rocker", "deg", 0, 20, True),
        ("rssr", "rocker", "deg", 80, 100, False),
        ("rssp", "slider", "mm", -300, 300, True),
        ("rssp", "slider", "mm", 2000, 3000, False),
    ],
)
def test_a_law_beyond_the_range_of_circuits_is_told_so(tmp_path, linkage, joint, unit, first, last, posed):
    times = np.linspace(0, 1, 61)
    write(tmp_path / "law.csv", f"time [s],{joint} [{unit}]", [times, first + (last - first) * times])
    arguments = ["analyze", linkage, "--input", joint, "--law", "law.csv", "--out", "out"]
    arguments += ["--animate", "move.gif"] if linkage == "rssr" and posed else []
    run = sevenbar(*arguments, cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    assert ("no row within the range" in run.stdout) == (linkage == "rssr" or not posed)
    assert "no bound" not in run.stdout
    rows = (tmp_path / "out" / "motion.csv").read_text().splitlines()[1:]
    assert {row.split(",")[3] for row in rows} == ({"ok", "no-solution"} if posed else {"no-solution"})
    assert (tmp_path / "out" / "motion.png").exists()
    assert (tmp_path / "out" / "configuration.png").exists() == posed


@pytest.mark.parametrize("linkage", ["rssr", "rssp"])
@pytest.mark.parametrize("rows", [1, 8])
def test_a_law_that_rests_is_a_motion_of_its_rows(tmp_path, linkage, rows):
    write(tmp_path / "law.csv", "t,q [deg],v [rad/s],a [rad/s2],j [rad/s3]",
          [np.arange(rows), np.full(rows, 10.0), *np.zeros((3, rows))])  # fmt: skip
    run = sevenbar("analyze", linkage, "--law", "law.csv", "--out", "out", cwd=tmp_path)
    assert (run.returncode, run.stderr) == (0, "writing out ..\n")
    assert len((tmp_path / "out" / "motion.csv").read_text().splitlines()) == 1 + 2 * rows


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--law", "none.csv"], "none.csv: no such file; give the path of a table of an input law"),
        (
            ["--law", "law.csv", "--speed", "1 rpm"],
            "--speed: a law gives the speed; leave --speed or --law out",
        ),
        (
            ["--law", "law.csv", "--out", "out"],
            "law.csv: has text but no row of numbers; give a table with a header and rows of numbers",
        ),
    ],
)
def test_a_law_that_cannot_be_read_ends_with_exit_2_and_writes_nothing(tmp_path, arguments, message):
    (tmp_path / "law.csv").write_text(HEAD)
    run = sevenbar("analyze", "rssr", *arguments, cwd=tmp_path)
    assert (run.returncode, run.stdout, run.stderr) == (2, "", f"sevenbar: {message}\n")
    assert [path.name for path in tmp_path.iterdir()] == ["law.csv"]
