"""Formulas in the place of numbers: their value by mpmath, their units, and what is no formula."""

import math
import tomllib

import mpmath
import numpy as np
import pytest

import sevenbar as sb
from sevenbar.commands.given import angles
from sevenbar.description.draft import Draft
from sevenbar.description.formulas import KINDS_OF_NUMBERS
from sevenbar.description.schema import TABLES
from sevenbar.errors import DescriptionError, RequestError
from sevenbar.text.amounts import value_of
from sevenbar.text.expression import FUNCTIONS, cosd, function_of, sind, tand

RSSR = "format = 1\n[drive]\nspeed = 2\n[rssr]\nM = 700\nN = 700\nL1 = {}\nL3 = 550\nD = 0\n"
BENNETT = """format = 1
[[link]]
length = 50
twist = 30
[[link]]
length = "50*sin(100deg)/sin(30deg)"
twist = "100 deg"
[[link]]
length = "5 cm"
twist = "pi/6"
[[link]]
length = "50*sind(100)/sind(30)"
twist = "5*pi/9"
"""


@pytest.mark.parametrize(
    ("text", "exact"),
    [
        ("50*sin(100deg)/sin(30deg)", lambda m: 50 * m.sin(m.radians(100)) / m.mpf("0.5")),
        ("sqrt((60mm)^2 + (2.5 cm)^2)", lambda m: m.sqrt(3600 + 625)),
        ("1in + 2 cm - 3mm", lambda m: m.mpf("25.4") + 17),
        ("2/3 m", lambda m: m.mpf(2000) / 3),
        ("2*pi*8", lambda m: 16 * m.pi),
        ("100*tan(pi/5)", lambda m: 100 * m.tan(m.pi / 5)),
        ("80*cosd(36.87)", lambda m: 80 * m.cos(m.radians(m.mpf("36.87")))),
        ("100*cos(acos(4/5))", lambda m: m.mpf(80)),
        ("-5 cm", lambda m: m.mpf(-50)),
        ("3×2·7", lambda m: m.mpf(42)),
        ("250", lambda m: m.mpf(250)),
        ("log10(1000)*e", lambda m: 3 * m.e),
    ],
)
def test_a_length_is_that_of_mpmath_to_the_last_digits(text, exact):
    with mpmath.workdps(40):
        wanted = float(exact(mpmath))
    assert value_of(text, "length") == pytest.approx(wanted, rel=4e-16)


@pytest.mark.parametrize(
    ("text", "degrees"),
    [("30", 30), ("30deg", 30), ("30°", 30), ("pi/6", 30), ("pi/6 rad", 30), ("asin(1/2)", 30), ("atan(1)", 45),
     ("-pi", -180), ("π/2", 90), ("2*acos(0)", 180), ("30deg + pi/6", 60), ("0.1", 0.1), ("2.6deg", 2.6)],
)  # fmt: skip
def test_an_angle_is_in_the_file_s_unit_without_one_and_one_of_pi_in_radians(text, degrees):
    assert value_of(text, "angle") == degrees
    plain = not text.strip(".0123456789")
    radians = value_of(text, "angle", angle_unit="rad")
    assert radians == pytest.approx(degrees if plain else math.radians(degrees), rel=4e-16)


def test_right_angles_have_exact_sines_and_cosines():
    turns = np.arange(-720, 721, 90)
    np.testing.assert_array_equal(sind(turns), np.tile([0, 1, 0, -1], 5)[: turns.size])
    np.testing.assert_array_equal(cosd(turns), np.tile([1, 0, -1, 0], 5)[: turns.size])
    assert value_of("100*cos(90deg)", "length") == 0 == value_of("100*cos(pi/2)", "length")
    assert value_of("100*sin(30deg)", "length") == 50
    with np.errstate(divide="ignore"):
        assert not math.isfinite(float(tand(90.0)))


@pytest.mark.parametrize("off", [1e-16, 1e-13, 1e-9, 1e-3])
def test_neighbours_of_right_angles_are_not_taken_for_them_beyond_rounding(off):
    wanted = math.radians(off) if off > 1e-12 else 0.0
    assert float(cosd(90.0 - off)) == pytest.approx(wanted, rel=1e-4)


@pytest.mark.parametrize(
    ("text", "kind", "message"),
    [
        ("2*L1", "length", "'2*L1': no 'L1' is known; give a length, as in 250, '25 cm' or '50*sin(30deg)'"),
        ("30deg", "length", "'30deg': is an angle where a length belongs; give a length"),
        ("0x10", "length", "'0x10': '0x1' begins no decimal number; write one, as in 16 or 1000"),
        ("1_000", "length", "'1_000': '1_0' begins no decimal number; write one, as in 16 or 1000"),
        ("5 mm", "angle", "'5 mm': is a length where an angle belongs; give an angle"),
        ("5mm*2cm", "length", "is an area where a length belongs"),
        ("5mm + 2", "length", "it adds a length and a number without a unit; give each its unit"),
        ("50*sin(100)", "length", "sin of a number without a unit; write sin(100deg), or sin(100 rad)"),
        ("asin(5mm)", "angle", "asin of a length; give a number without a unit"),
        ("30 + pi", "angle", "it adds a number of pi and another; give each its unit"),
        ("700,5", "length", "it has a comma; write a decimal point, as in 0.5"),
        ("300 mmm", "length", "'mmm' is not a unit known here; did you mean 'mm'? allowed: um, mm"),
        ("2 pi", "angle", "there is no sign before 'pi'; write *, as in 2*pi"),
        ("1/0", "length", "'1/0' has no finite value"),
        ("9^9^9^9", "length", "has no finite value"),
        ("1mm/0", "length", "has no finite value"),
        ("(5mm)^0.3", "length", "neither length nor angle"),
        ("2^(3mm)", "length", "a length is no exponent"),
        ("__import__('os')", "length", "no function '__import__' is known"),
        ("(1).real", "length", "it holds more than numbers"),
        ("1 if 1 else 2", "length", "it holds more than numbers"),
        ("x", "length", "no 'x' is known"),
        ("", "length", "it is not a formula"),
        ("(" * 150 + "1" + ")" * 150, "length", "characters are too long"),
    ],
)
def test_what_is_no_formula_is_refused_in_a_line(text, kind, message):
    with pytest.raises(RequestError, match=r"^[^\n]*$") as refused:
        value_of(text, kind)
    assert message in str(refused.value)


def test_a_function_of_x_and_a_dimension_have_the_same_functions():
    x = np.linspace(0.1, 0.9, 5)
    for name in FUNCTIONS:
        np.testing.assert_allclose(function_of(f"{name}(x)")(x), FUNCTIONS[name](x), rtol=1e-15)
    np.testing.assert_allclose(function_of("sind(90*x)")(x), np.sin(np.pi / 2 * x), rtol=1e-14)
    np.testing.assert_allclose(function_of("sin(90deg*x)")(x), np.sin(np.pi / 2 * x), rtol=1e-14)


def test_a_bennett_loop_by_its_formula_moves_and_by_six_digits_does_not():
    linkage = sb.loads(BENNETT)
    assert linkage.motion(36).motion_type == "double-crank"
    assert linkage.dimensions["twist_3_deg"] == 30
    assert linkage.description["link"][1]["length"] == pytest.approx(98.480775301220802, rel=1e-15)
    rounded = BENNETT
    for formula in ('"50*sin(100deg)/sin(30deg)"', '"50*sind(100)/sind(30)"'):
        rounded = rounded.replace(formula, "98.4808")
    assert sb.loads(rounded).motion(36).motion_type == "rigid"


def test_every_number_of_a_file_may_be_a_formula_and_the_kinds_are_the_schema_s():
    units = {
        "length": "length",
        "length per turn": "pitch",
        "angle_unit": "angle",
        "mass_unit": "mass",
        "mass_unit length_unit^2": "inertia",
        "kg/m^3": "density",
        "m/s^2": "acceleration",
        "N": "force",
        "N m": "torque",
        "angle_unit, or length": "angle",
        "N/length_unit; in a joint that turns N m/rad": "stiffness",
        "N s/length_unit; in a joint that turns N m s/rad": "damping",
    }
    for head, form in TABLES.items():
        told = {
            name: units[field.json_schema_extra["unit"]]
            for name, field in form.model_fields.items()
            if field.json_schema_extra and head != "drive"
        }
        assert {key: kind for key, kind in KINDS_OF_NUMBERS.get(head, {}).items() if kind != "number"} == told


@pytest.mark.parametrize(
    ("text", "speed"),
    [
        ("2*pi*5 rad/s", 10 * math.pi),
        ("3000/60 rev/s", 100 * math.pi),
        ("10 rad/s", 10),
        ("(1+1)rpm", math.pi / 15),
    ],
)
def test_a_speed_may_be_a_formula_before_its_unit(text, speed):
    found = sb.loads(RSSR.format(250).replace("speed = 2", f'speed = "{text}"')).drive.speed
    assert found == pytest.approx(speed, rel=1e-15)


def test_a_wrong_formula_of_a_speed_is_refused():
    with pytest.raises(DescriptionError, match=r"drive.speed: '2\*p': no 'p' is known; give a number"):
        sb.loads(RSSR.format(250).replace("speed = 2", 'speed = "2*p rad/s"'))


def test_a_drawing_takes_formulas_in_places_and_axes():
    drawn = """format = 1
[[joint]]
kind = "R"
at = ["10cm*cos(60deg)", 0, "-1 in"]
axis = ["cos(60deg)", "sin(60deg)", 0]
[[joint]]
kind = "S"
at = [0, "3cm", 0]
[[joint]]
kind = "S"
at = [50, 60, 70]
[[joint]]
kind = "H"
pitch = "2*4mm/turn"
at = [0, 0, 90]
axis = [1, 0, 0]
[[point]]
name = "P"
link = 1
at = ["1cm", 0, 0]
"""
    description = sb.loads(drawn).description
    assert description["joint"][0]["at"] == [50.0, 0, -25.4]
    assert description["joint"][0]["axis"] == [pytest.approx(0.5), pytest.approx(math.sqrt(0.75)), 0]
    assert (description["joint"][3]["pitch"], description["point"][0]["at"]) == (8.0, [10.0, 0, 0])


def test_a_wrong_formula_of_a_file_has_its_place():
    with pytest.raises(DescriptionError) as refused:
        sb.loads(RSSR.format('"-5 cm"').replace("N = 700", 'N = "30deg"'), "f.toml")
    assert str(refused.value).splitlines() == [
        "f.toml: rssr.N: '30deg': is an angle where a length belongs; give a length, as in 250, '25 cm' or '50*sin(30deg)'",
        "f.toml: rssr.L1: -50.0 is not a length; give a number > 0",
    ]


def test_a_file_that_is_written_again_keeps_its_formulas_but_for_the_changed_number():
    text = RSSR.format('"25 cm"  # the crank').replace("M = 700", 'M = "70 cm"')
    draft = Draft.of(text, "f.toml")
    assert draft.dimension("L1").value == 250
    assert draft.toml() == text
    changed = draft.with_values({"L1": 260.0}).toml()
    assert 'M = "70 cm"' in changed
    assert tomllib.loads(changed)["rssr"]["L1"] == 260
    assert "# the crank" in changed


def test_calls_take_the_angles_that_constructors_take():
    linkage = sb.load("rssr")
    for text in ("pi/6", "30 deg", "acos(sqrt(3)/2)", "90deg - pi/3"):
        modes = linkage.assembly_modes(text)
        assert modes.input == pytest.approx(math.pi / 6, rel=1e-15)
        np.testing.assert_array_equal(modes.q, linkage.assembly_modes(modes.input).q)
        assert sb.universal_joint(text, 10).description == sb.universal_joint("30 deg", 10).description
    np.testing.assert_array_equal(
        linkage.output(["pi/6", 0.3, "-pi/2"]).position,
        linkage.output([math.pi / 6, 0.3, -math.pi / 2]).position,
    )


@pytest.mark.parametrize("text", ["2*15", "30", "60*sin(30deg)"])
def test_in_python_an_angle_without_a_unit_is_in_nothing(text):
    for call in (
        lambda: sb.load("rssr").assembly_modes(text),
        lambda: sb.universal_joint(text, 10),
        lambda: sb.from_dh("RRRR", length=[1] * 4, twist=[text] * 4),
    ):
        with pytest.raises(RequestError, match="give one as in '30 deg', or a number in radians"):
            call()


@pytest.mark.parametrize(
    ("text", "ends"),
    [("0:pi/6", (0, 30)), ("2*5:40deg", (10, 40)), ("-pi/6:2*20deg", (-30, 40)), ("10:2*20 deg", (10, 40))],
)
def test_the_ends_of_a_range_may_be_formulas(text, ends):
    assert np.degrees(angles("--input-range", text)) == pytest.approx(ends, rel=1e-15)
