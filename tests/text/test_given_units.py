"""Numbers that come with their unit, and numbers that may have come in another one."""

import math
import warnings

import numpy as np
import pytest

import sevenbar as sb
from command_runs import sevenbar
from sevenbar.errors import AngleUnitWarning, DescriptionError, RequestError, SevenbarError

TWISTS_DEG = [80, -95, 0, 0, -75, 80, 150]
LENGTHS = [45, 15, 100, -115, 10, 35, 35]
OFFSETS = [70, 10, 10, 10, 10, 10, -60]


def seven_r(length=LENGTHS, twist=None, offset=OFFSETS, **more):
    twist = [f"{t} deg" for t in TWISTS_DEG] if twist is None else twist
    return sb.from_dh("R" * 7, length=length, twist=twist, offset=offset, **more)


def test_rows_take_texts_with_units():
    whole = sb.load("seven_r")
    for linkage in (
        seven_r(),
        seven_r(
            twist=["80deg", "-95\u00b0", 0, 0.0, f"{math.radians(-75)!r} rad", "80 deg", math.radians(150)]
        ),
        seven_r(length=["4.5 cm", "15mm", "0.1 m", -115, 10, 35, 35], offset=np.array(OFFSETS)),
    ):
        np.testing.assert_allclose(linkage.transforms, whole.transforms, rtol=0, atol=1e-13)
    kept = sb.from_dh(
        "RPH",
        length=["1 in", 2, 3],
        twist=[0, "1 rad", 0],
        offset=["4 mm", None, 5],
        angle=[None, "30 deg", None],
        pitch=[None, None, "0.7 cm/turn"],
    )
    assert kept.dimensions["length_1"] == 25.4
    assert kept.dimensions["angle_2_deg"] == 30.0
    assert kept.joints[2].pitch == 7.0


def test_the_rssr_and_a_drawing_take_texts_with_units():
    assert (
        sb.rssr(M="70 cm", N=700, L1="25cm", L3="0.55 m", D=0).dimensions
        == sb.rssr(700, 700, 250, 550, 0).dimensions
    )
    joints = [
        {"kind": "R", "at": (0, 0, "70 cm"), "axis": (0, 0, 1)},
        {"kind": "H", "at": ("1 in", 0, 0), "axis": (0, 1, 1), "pitch": "1 in/turn"},
        {"kind": "R", "at": (0, 0, 0), "axis": (1, 0, 0)},
    ]
    linkage = sb.from_axes(joints, points=[{"name": "P", "link": 1, "at": ["2 cm", 0, 1]}])
    assert linkage.description["joint"][0]["at"] == [0, 0, 700.0]
    assert linkage.joints[1].pitch == 25.4
    assert linkage.points[0].at == (20.0, 0.0, 1.0)


def test_values_of_the_input_take_texts_with_units():
    linkage = sb.load("seven_r")
    np.testing.assert_array_equal(
        linkage.assembly_modes("30 deg").q, linkage.assembly_modes(30 * (math.pi / 180)).q
    )
    rssr = sb.load("rssr")
    np.testing.assert_array_equal(
        rssr.output(["30deg", 0.3, "0.5 rad"]).position,
        rssr.output([30 * (math.pi / 180), 0.3, 0.5]).position,
    )
    slider = sb.load("rssp")
    assert slider.assembly_modes("1 cm", input="slider").input == 10.0
    pose = linkage.assembly_modes(0.3).q[2]
    texts = [f"{math.degrees(value)!r} deg" for value in pose]
    assert linkage.circuit(texts, 36).motion_type == linkage.circuit(pose, 36).motion_type


@pytest.mark.parametrize("given", ["30", "30 mm", "deg", "", "wide", "30 grad", "nan deg", "1e999 deg"])
def test_a_text_without_a_unit_that_fits_is_refused(given):
    for call in (
        lambda: sb.load("seven_r").assembly_modes(given),
        lambda: sb.load("rssr").output([0.3, given]),
        lambda: sb.load("seven_r").circuit([given] * 7),
    ):
        with pytest.raises(
            RequestError, match=r"is not a number with a unit that fits; give one as in '30 deg', or a"
        ):
            call()
    with pytest.raises(SevenbarError, match=r"link\[2\]\.twist: |twist\[1\]: "):
        seven_r(twist=[0, given, 0, 0, 0, 0, 0])


def test_degrees_in_place_of_radians_are_doubted():
    with pytest.warns(
        AngleUnitWarning, match="twist of link 1 is 80 rad, more than a turn; is it in degrees?"
    ):
        seven_r(twist=TWISTS_DEG)
    with pytest.warns(AngleUnitWarning, match=r"text: all twists are at most 3\.14 deg; are they in radians"):
        sb.loads("format = 1\n[[link]]\ntwist = 1\n[[link]]\ntwist = -3.14\n[[link]]\n")
    with pytest.warns(AngleUnitWarning, match="twist of link 2 is 400 deg, more than a turn"):
        sb.loads("format = 1\n[[link]]\ntwist = 1\n[[link]]\ntwist = 400\n[[link]]\n")


@pytest.mark.parametrize("twists", [[0, 0, 0], [90, 1, 2], [360, -360, 0], [3.5, 0, 1], [0.375, 0, 0]])
def test_ordinary_twists_in_degrees_are_not_doubted(twists):
    rows = "".join(f"[[link]]\ntwist = {twist}\n" for twist in twists)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sb.loads(f"format = 1\n{rows}")
        sb.from_dh("RRR", length=[1] * 3, twist=np.radians(twists), offset=[0] * 3)


def test_no_linkage_of_the_gallery_is_doubted():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for name in sb.gallery.names():
            sb.load(name)


def test_the_report_has_the_doubt_and_other_commands_have_it_on_the_error_stream(tmp_path):
    file = tmp_path / "loop.toml"
    rows = "".join(f"[[link]]\nlength = 1\ntwist = {twist}\n" for twist in (80, -95, 80, -95))
    file.write_text(f'format = 1\nangle_unit = "rad"\n{rows}')
    done = sevenbar("analyze", file)
    assert "twist of link 1 is 80 rad, more than a turn" in done.stdout
    assert done.stderr == ""
    done = sevenbar("modes", file)
    assert done.stderr == (
        f'sevenbar: {file}: twist of link 1 is 80 rad, more than a turn; is it in degrees? (angle_unit is "rad")\n'
    )
    assert "Warning" not in done.stderr + done.stdout
    # a warning of one command is none of the next
    assert sevenbar("modes", file).stderr == done.stderr


def test_two_inputs_are_refused_by_what_they_are():
    with pytest.raises(DescriptionError) as caught:
        sb.loads('format = 1\n[drive]\njoint = ["crank", "rocker"]\n[rssr]\nM=1\nN=1\nL1=1\nL3=2\nD=0\n')
    assert str(caught.value) == (
        "text: drive.joint: ['crank', 'rocker'] are 2 inputs; a linkage has one input here, so give one joint, as in "
        "'crank'; with two inputs lock one of them: leave that joint out"
    )


def test_a_planar_five_bar_is_to_be_locked_and_nothing_else():
    linkage = sb.from_dh("R" * 5, length=[1, 2, 2, 2, 2], twist=[0] * 5, offset=[0] * 5)
    page = sb.report.markdown(linkage.motion(12))
    assert (
        "the loop moves with 2 freedoms, so one input does not determine it: lock a joint (leave it out)"
        in page
    )
    assert "drive" not in page.partition("one input does not")[2].partition("\n")[0]


def test_a_speed_is_read_alike_in_files_and_in_calls():
    rssr = sb.load("rssr")
    assert rssr.motion(12, speed="2*3 rad/s").speed == 6.0
    assert rssr.motion(12, speed="90\u00b0/s").speed == math.pi / 2
