"""Tables of measured values: what is read from each kind of file, and what is said of each that cannot be read."""

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.errors import RequestError, TableError
from sevenbar.export.tables import write_csv
from sevenbar.measuring.measured import Ends, Measured, MeasuredExtremes, pairs, read_measured
from sevenbar.text.units import measured_unit

ENDS = Ends("crank", "rocker")
SLIDER = Ends("crank", "slider", output_slides=True, length_unit="mm")


def read(tmp_path, text, ends=ENDS, **options):
    path = tmp_path / "measured.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_measured(path, ends, **options)


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("time [s],angle [deg]\n0,90\n0.5,180\n", {"time": [0, 0.5], "angle": [np.pi / 2, np.pi]}),
        ("time_s,rocker_deg\n0,90\n0.5,180\n", {"time": [0, 0.5], "angle": [np.pi / 2, np.pi]}),
        ("t (ms);output (rad)\n0;1,5\n500;2,5\n", {"time": [0, 0.5], "angle": [1.5, 2.5]}),
        ("crank [°]\trocker velocity [1/min]\n0\t60\n180\t30\n".replace("1/min", "rpm"),
         {"input": [0, np.pi], "velocity": [2 * np.pi, np.pi]}),
        ("Time,omega,acc\ns,deg/s,rad/s^2\n0,180,1\n1,90,2\n",
         {"time": [0, 1], "velocity": [np.pi, np.pi / 2], "acceleration": [1, 2]}),
        ("% time [s]   angle [rad]\n  0.0e+00   1.0e+00\n  1.0e+00   2.0e+00\n", {"time": [0, 1], "angle": [1, 2]}),
        ("Measures of model_1\n\n      Time         VEL\n     (sec)   (deg/sec)\n 0.0E+000  1.8D+002\n 1.0E+000  9.0D+001\n",
         {"time": [0, 1], "velocity": [np.pi, np.pi / 2]}),
        ('"Time (sec)"\t"angular acceleration (rad/sec**2)"\n0.0\t1.0\n1.0\t2.0\n',
         {"time": [0, 1], "acceleration": [1, 2]}),
        ("time [s];angle [rad]\n0;0\n0,5;1,5\n", {"time": [0, 0.5], "angle": [0, 1.5]}),
        ("time [s],angle [rev]\n% from a bench, by hand\n0,0.5\n,\n1,1\n,\n",
         {"time": [0, 1], "angle": [np.pi, 2 * np.pi]}),
        ("time [s],angle [deg],\n0,90,\n0.5,180,\n", {"time": [0, 0.5], "angle": [np.pi / 2, np.pi]}),
        ("time [s],angle [deg]\n\n0,90\n# a remark\n0.5,180\n", {"time": [0, 0.5], "angle": [np.pi / 2, np.pi]}),
        ("time [s],angle [deg]\r\n0,90\r\n0.5,180\r\n".encode("utf-16"), {"time": [0, 0.5], "angle": [np.pi / 2, np.pi]}),
        ("time [s],angle [°]\n0,90\n0.5,180\n".encode("cp1252"), {"time": [0, 0.5], "angle": [np.pi / 2, np.pi]}),
    ],
)  # fmt: skip
def test_each_kind_of_table_comes_out_in_seconds_and_radians(tmp_path, text, wanted):
    measured = read(tmp_path, text)
    assert isinstance(measured, Measured)
    assert set(measured.values) == set(wanted)
    for quantity, values in wanted.items():
        np.testing.assert_allclose(measured.values[quantity], values, rtol=1e-15)


def test_a_table_without_header_is_read_by_the_numbers_of_its_columns(tmp_path):
    text = "   0.0000000e+00   9.0000000e+01   7\n   1.0000000e+00   1.8000000e+02   7\n"
    measured = read(tmp_path, text, columns={"time": "1", "angle": "2"}, units={"time": "s", "angle": "deg"})
    np.testing.assert_allclose(measured.values["angle"], [np.pi / 2, np.pi])


def test_a_column_of_another_program_is_named_by_the_caller(tmp_path):
    text = "Time (sec),.model_1.JOINT_4_MEA (deg)\n0,90\n1,180\n"
    measured = read(tmp_path, text, columns={"angle": ".model_1.JOINT_4_MEA"})
    np.testing.assert_allclose(measured.values["angle"], [np.pi / 2, np.pi])
    assert measured.labels == {"angle": ".model_1.JOINT_4_MEA (deg)", "time": "Time (sec)"}


def test_rows_keep_the_lines_of_their_file(tmp_path):
    measured = read(tmp_path, "made by hand\ntime [s],angle [rad]\n0,1\n\n1,nan\n2,3\n", skip_nan=True)
    assert measured.line.tolist() == [3, 6]
    assert measured.left_out == 1


def test_a_slide_comes_out_in_the_linkage_s_length_unit(tmp_path):
    measured = read(tmp_path, "time [s],slider [cm],velocity [m/s]\n0,1,2\n1,2,3\n", SLIDER)
    np.testing.assert_allclose(measured.values["angle"], [10, 20], rtol=1e-15)
    np.testing.assert_allclose(measured.values["velocity"], [2000, 3000], rtol=1e-15)


def test_the_rows_that_sevenbar_writes_are_read_back(tmp_path):
    motion = sb.load("rssr").motion(36)
    write_csv(motion, tmp_path / "motion.csv", "file")
    lines = (tmp_path / "motion.csv").read_text().splitlines()
    (tmp_path / "measured.csv").write_text("\n".join(lines[:37]) + "\n")
    measured = read_measured(tmp_path / "measured.csv", ENDS)
    circuit = motion.circuits[0]
    for quantity, values in (
        ("time", circuit.time),
        ("input", circuit.input),
        ("angle", circuit.output),
        ("velocity", circuit.dq[:, -1]),
        ("acceleration", circuit.ddq[:, -1]),
    ):
        np.testing.assert_allclose(measured.values[quantity], values, rtol=1e-14, atol=1e-14)


def test_extremes_are_a_table_of_their_own(tmp_path):
    text = "quantity,lowest,highest\nangle [deg],-90,180\nvelocity [rad/s],-5,7.5\n"
    measured = read(tmp_path, text)
    assert isinstance(measured, MeasuredExtremes)
    assert measured.values["angle"] == pytest.approx((-np.pi / 2, np.pi), rel=1e-15)
    assert measured.values["velocity"] == (-5.0, 7.5)


HEADER = "time [s],angle [deg]\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty; give a table with a header and rows of numbers"),
        (" \n\n", "is empty; give a table with a header and rows of numbers"),
        (HEADER, "has text but no row of numbers; give a table with a header and rows of numbers"),
        (bytes(range(256)), "not a table of text (it holds bytes that no text has); export it as CSV or text"),
        (HEADER + "0,1\n1\n2,3\n",
         "line 3: 1 cell where line 2 has 2; the file is cut or damaged there, or holds a second table: mend it"),
        (HEADER + "0,1\nend of file\n",
         "line 3: 'end of file' is no row of numbers; the file is cut or damaged there, or holds a second table: mend it"),
        (HEADER + "0,1\n1,abc\n", "line 3, column 'angle [deg]': 'abc' is not a number; mend the cell or leave the row out"),
        (HEADER + "0,1\n", "one row of measured values; give at least two"),
        ("time [s],torque [Nm]\n0,1\n1,2\n",
         "no column for the angle, velocity or acceleration of the output 'rocker'; the columns are 'time [s]', 'torque "
         "[Nm]'; name them as in 'angle [deg]', or say which with --column angle=NAME or its number"),
        ("angle [deg],torque [Nm]\n0,1\n1,2\n",
         "no column for the time or for the input 'crank'; the columns are 'angle [deg]', 'torque [Nm]'; name them as in "
         "'time [s]', or say which with --column time=NAME or its number"),
        ("0 1\n1 2\n",
         "no column for the angle, velocity or acceleration of the output 'rocker'; the file has no header; name them as "
         "in 'angle [deg]', or say which with --column angle=NAME or its number"),
        ("time,angle\n0,1\n1,2\n", "column 'time': has no unit; write it as in 'time [s]', or give --unit time=s"),
        ("time [s],angle [grad]\n0,1\n1,2\n", "column 'angle [grad]': 'grad' is not a unit known here; give one like deg"),
        ("time [s],angle [mm]\n0,1\n1,2\n", "column 'angle [mm]': 'mm' is not a unit of the angle; give one like deg"),
        ("time [s],angle [deg]\ns,rad\n0,1\n1,2\n",
         "mixed units: column 'angle [deg]' has 'deg' in its name and 'rad' in the line of units; keep the right one"),
        ("time [s],angle [deg],angle [rad]\n0,1,1\n1,2,2\n",
         "line 1: mixed units: 'angle [deg]' and 'angle [rad]' both hold the angle; choose with --column angle=NAME"),
        (HEADER + "0,1\n1,2 rad\n",
         "line 3, column 'angle [deg]': '2 rad' carries a unit of its own; write plain numbers, all in the one unit that "
         "the header names"),
        (HEADER + "0,1\n1,NaN\n2,2\n",
         "line 3: no number in column 'angle [deg]' ('NaN'); mend it, or leave such rows out with --skip-nan"),
        (HEADER + "0,1\n1,\n2,inf\n3,-\n4,n/a\n5,6\n",
         "lines 3, 4, 5 and 1 more: no number in column 'angle [deg]' (''); mend them, or leave such rows out with --skip-nan"),
        (HEADER + ",1\n1,2\n2,2\n",
         "line 2: no number in column 'time [s]' (''); mend it, or leave such rows out with --skip-nan"),
        (HEADER + "0,1\n2,2\n1,3\n",
         "line 4: time 1 after 2 in line 3; times must rise: sort the rows, and keep one run only"),
        (HEADER + "0,1\n1,2\n1,3\n0,2\n",
         "line 4: time 1 again, as in line 3 (and so 1 more times); times must rise: sort the rows, and keep one run only"),
        ("quantity,lowest,highest\nangle [rad],1,0\n",
         "line 2: lowest and highest are not two rising numbers; mend the line"),
        ("quantity,lowest,highest\nangle,0,1\n", "line 2: angle has no unit; write 'angle [deg]'"),
        ("quantity,lowest,highest\n", "has a header but no row; give a line for each of angle, velocity, acceleration"),
    ],
)  # fmt: skip
def test_each_broken_table_has_its_own_message(tmp_path, text, message):
    with pytest.raises(TableError) as caught:
        read(tmp_path, text)
    assert str(caught.value) == f"{tmp_path / 'measured.csv'}: {message}"


def test_whatever_is_done_to_a_table_it_is_read_or_told(tmp_path):
    rng = np.random.default_rng(7)
    whole = "time [s],angle [deg],velocity [rad/s]\n" + "".join(
        f"{i / 10},{i},{-i / 7:.3e}\n" for i in range(12)
    )
    marks = [
        *list(',;\t \n\r"#%-+.eE[]()/x0na°²'),
        "1e999",
        "nan",
        "deg",
        ",,",
        "lowest",
        "quantity,lowest,highest\n",
    ]
    read_well = 0
    for _ in range(1500):
        text = whole
        for _ in range(rng.integers(1, 5)):
            at, cut = rng.integers(0, len(text) + 1), rng.integers(0, 6)
            text = (
                text[:at] + (marks[rng.integers(len(marks))] if rng.random() < 0.7 else "") + text[at + cut :]
            )
        try:
            measured = read(tmp_path, text)
        except TableError as error:
            assert str(error).startswith(str(tmp_path / "measured.csv"))
            continue
        assert isinstance(measured, Measured)
        assert all(
            np.isfinite(values).all() and len(values) == len(measured) for values in measured.values.values()
        )
        read_well += 1
    assert 0 < read_well < 1500


def test_a_line_without_end_is_no_row(tmp_path):
    with pytest.raises(TableError, match="line 2 has 400000 characters, so it is no row of a table"):
        read(tmp_path, "time [s],angle [deg]\n" + "1," * 200_000)


def test_a_unit_of_the_caller_must_not_contradict_the_header(tmp_path):
    with pytest.raises(TableError, match=r"mixed units: .* is in 'deg' by its header and in 'rad' by --unit"):
        read(tmp_path, HEADER + "0,1\n1,2\n", units={"angle": "rad"})


def test_a_column_that_is_not_there_is_told_with_those_that_are(tmp_path):
    with pytest.raises(
        TableError, match=r"no column 'beta' for the angle; the file has 'time .s.', 'angle .deg.'"
    ):
        read(tmp_path, HEADER + "0,1\n1,2\n", columns={"angle": "beta"})


@pytest.mark.parametrize("path", ["no.csv", "."])
def test_a_table_that_is_no_file_is_told(tmp_path, monkeypatch, path):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(TableError, match=r"no such file|is a folder"):
        read_measured(path, ENDS)


@pytest.mark.parametrize("word", ["angle", "angle=", "torque=2", "=3"])
def test_a_pair_that_is_none_is_told(word):
    with pytest.raises(RequestError, match=r"--column: .* is not understood; give one of time, input, angle"):
        pairs([word], "--column")


def test_a_pair_given_twice_is_told():
    with pytest.raises(RequestError, match="angle is given twice"):
        pairs(["angle=1", "angle=2"], "--column")


@pytest.mark.parametrize(
    ("text", "kind", "order", "size"),
    [
        ("deg/sec**2", "turn", 2, np.pi / 180),
        ("rad/s²", "turn", 2, 1.0),
        ("Radians / second", "turn", 1, 1.0),
        ("rev/min", "turn", 1, 2 * np.pi / 60),
        ("°", "turn", 0, np.pi / 180),
        ("millimeter/sec", "slide", 1, 1e-3),
        ("msec", "time", 0, 1e-3),
        ("rad/s3", "turn", 3, 1.0),
        ("rad/s³", "turn", 3, 1.0),
        ("rev", "turn", 0, 2 * np.pi),
    ],
)
def test_units_are_read_as_programs_write_them(text, kind, order, size):
    unit = measured_unit(text)
    assert (unit.kind, unit.order) == (kind, order)
    assert unit.size == pytest.approx(size, rel=1e-15)


@pytest.mark.parametrize("text", ["", "grad", "deg/m", "s/deg", "Nm", "status", "mea"])
def test_other_words_are_no_units(text):
    assert measured_unit(text) is None
