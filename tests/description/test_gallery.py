"""The gallery: how each linkage moves, and one law of each held against its source or theory.

The laws are worked out here from the numbers of the file with NumPy alone, in another way than by closing the loop.
`FACTS` was found by a follower of its own beforehand: Newton's method from many starts at six inputs, each mode
followed by arc length till it came back, and no pose on the way near a second way to move.
"""

from __future__ import annotations

import json
import tomllib
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pytest

import sevenbar as sb
from places import REFERENCES
from sevenbar.description import gallery

Floats = np.ndarray

SAMPLES = 120

#: Error [rad, or parts of a length] of a law that holds exactly: what rounding leaves of a well-conditioned pose.
EXACT = 1e-12

#: The same where an acos or a root of a quartic stands in the law: rounding is magnified near the ends of a swing.
NEARLY = 1e-9

#: Relative error of a velocity in a well-conditioned pose.
RATE = 1e-10

#: Closure error [length] of a row; the linkages are some hundred units large.
CLOSED = 1e-10


class Facts(NamedTuple):
    """What is known of a linkage: `types` of its circuits, sorted; `modes` at the input of 0.3 rad."""

    kind: str
    motion_type: str
    types: tuple[str, ...]
    modes: int
    gruebler: int
    rank: int
    idle: int = 0
    turns: int = 1


def alike(motion_type: str, circuits: int) -> tuple[str, tuple[str, ...]]:
    return motion_type, (motion_type,) * circuits


#: Gruebler count: all freedoms of the joints less 6. Redundant constraints: 6 less the rank.
FACTS = {
    "bennett": Facts("RRRR", *alike("double-crank", 1), modes=1, gruebler=-2, rank=3),
    "bricard_line": Facts("RRRRRR", *alike("crank-rocker", 2), modes=2, gruebler=0, rank=5),
    "bricard_plane": Facts("RRRRRR", *alike("crank-rocker", 2), modes=2, gruebler=0, rank=5),
    "bricard_trihedral": Facts("RRRRRR", *alike("double-rocker", 1), modes=2, gruebler=0, rank=5, turns=0),
    "engine": Facts("RRRP", *alike("crank-slider", 2), modes=2, gruebler=-2, rank=3),
    "five_bar": Facts("RRSRR", *alike("double-crank", 4), modes=4, gruebler=1, rank=6),
    "goldberg_5r": Facts("RRRRR", *alike("double-crank", 1), modes=1, gruebler=-1, rank=4),
    "myard_5r": Facts("RRRRR", *alike("double-crank", 1), modes=2, gruebler=-1, rank=4, turns=2),
    "planar_4r": Facts("RRRR", *alike("crank-rocker", 2), modes=2, gruebler=-2, rank=3),
    "rccc": Facts("RPRPRPR", *alike("crank-rocker", 2), modes=2, gruebler=1, rank=6),
    "rscr": Facts(
        "RSCR", "mixed", ("crank-rocker", "crank-rocker", "double-rocker"), modes=4, gruebler=1, rank=6
    ),
    "rssp": Facts("RSSP", *alike("crank-slider", 2), modes=2, gruebler=2, rank=6, idle=1),
    "rssr": Facts("RSSR", *alike("crank-rocker", 2), modes=2, gruebler=2, rank=6, idle=1),
    "rssr_press": Facts("RSSR", *alike("crank-rocker", 2), modes=2, gruebler=2, rank=6, idle=1),
    "rsur": Facts("RSUR", *alike("crank-rocker", 4), modes=4, gruebler=1, rank=6),
    "sarrus": Facts("RRRRRR", *alike("crank-rocker", 4), modes=4, gruebler=0, rank=5),
    "screw_drill": Facts("RRRHR", *alike("crank-rocker", 2), modes=2, gruebler=-1, rank=4),
    "seven_r": Facts("RRRRRRR", *alike("double-crank", 8), modes=8, gruebler=1, rank=6),
    "seven_r_bodies": Facts("RRRRRRR", *alike("double-crank", 8), modes=8, gruebler=1, rank=6),
    "six_bar": Facts("RRRRRC", *alike("crank-rocker", 4), modes=4, gruebler=1, rank=6),
    "spherical_4r": Facts("RRRR", *alike("crank-rocker", 2), modes=2, gruebler=-2, rank=3),
    "swash_plate": Facts("REUP", *alike("crank-slider", 2), modes=2, gruebler=1, rank=6),
    "universal_joint": Facts("RUR", *alike("double-crank", 2), modes=2, gruebler=-2, rank=3),
}


@cache
def moved(name: str) -> sb.Motion:
    return sb.load(name).motion(samples=SAMPLES)


@cache
def written(name: str) -> dict[str, Any]:
    """The file as TOML alone reads it."""
    return tomllib.loads(gallery.text(name))


def rows(name: str, key: str) -> Floats:
    """The numbers of the Denavit-Hartenberg rows of a file, angles in radians."""
    values = np.array([row.get(key, 0) for row in written(name)["link"]], dtype=float)
    return np.radians(values) if key == "twist" else values


def drawn(name: str, joint: str, key: str = "at") -> Floats:
    """A place of a drawn file, or a direction of length 1."""
    vector = np.array(next(j for j in written(name)["joint"] if j["name"] == joint)[key], dtype=float)
    return vector if key == "at" else vector / np.linalg.norm(vector)


def of(circuit: sb.Circuit, *columns: str) -> list[Floats]:
    return [circuit.q[:, circuit.columns.index(column)] for column in columns]


def thetas(circuit: sb.Circuit) -> Floats:
    """All turns of a loop of R joints, (joints, n)."""
    return circuit.q.T


def apart(first: Floats, second: Floats) -> Floats:
    """Differences of angles."""
    return np.abs((np.asarray(first) - second + np.pi) % (2 * np.pi) - np.pi)


def turned(axis: Floats, angle: Floats, vector: Floats) -> Floats:
    """A vector turned about a unit axis by each of many angles, (n, 3): Rodrigues' formula."""
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    return c * vector + s * np.cross(axis, vector) + (1 - c) * (vector @ axis) * axis


def angles_with(a: Floats, b: Floats, c: Floats) -> Floats:
    """Both solutions (2, n) of `a cos x + b sin x = c`."""
    middle, half = np.arctan2(b, a), np.arccos(c / np.hypot(a, b))
    return np.array([middle + half, middle - half])


def each_is_one_of(solutions: Floats, outputs: list[Floats]) -> Floats:
    """The error of the outputs (each (n,)) against solutions (k, n); every solution must be somebody's."""
    errors = np.array([apart(solutions, output).max(axis=1) for output in outputs])
    assert set(errors.argmin(axis=1)) == set(range(len(solutions)))
    return errors.min(axis=1)


# How they move


def test_the_table_holds_the_whole_gallery() -> None:
    assert sorted(FACTS) == list(gallery.loops())


@pytest.mark.parametrize("name", FACTS)
def test_a_file_names_its_source_and_its_drive(name: str) -> None:
    text = gallery.text(name)
    comment = " ".join(line.lstrip("# ") for line in text.split("format = 1")[0].splitlines())
    assert any(word in comment for word in ("(1", "ours", "Sun and Zhou", "7R spatial mechanism"))
    assert "speed" in written(name)["drive"]
    assert sb.load(name).kind == FACTS[name].kind


@pytest.mark.parametrize("name", FACTS)
def test_motion_type_and_circuits(name: str) -> None:
    motion, facts = moved(name), FACTS[name]
    assert motion.motion_type == facts.motion_type
    assert tuple(sorted(circuit.motion_type for circuit in motion.circuits)) == facts.types
    for circuit in motion.circuits:
        rocks = circuit.motion_type.startswith(("rocker", "double-rocker"))
        assert circuit.closed
        assert circuit.turns == (0 if rocks else facts.turns)
        assert circuit.residual.max() < CLOSED
    cranks = not any("double-rocker" in t for t in facts.types)
    assert (len(motion.limits) == 0) == cranks


@pytest.mark.parametrize("name", FACTS)
def test_modes_at_an_input(name: str) -> None:
    assert len(sb.load(name).assembly_modes(0.3)) == FACTS[name].modes


@pytest.mark.parametrize("name", FACTS)
def test_freedoms_are_counted_and_told_apart(name: str) -> None:
    mobility, facts = moved(name).mobility, FACTS[name]
    assert mobility.gruebler == facts.gruebler
    assert mobility.rank == facts.rank
    assert len(mobility.idle) == facts.idle
    assert len(mobility.redundant) == 6 - facts.rank
    if not facts.idle:
        assert mobility.finite == 1


# Planar and spherical


def test_planar_4r_obeys_freudensteins_equation() -> None:
    """`|l4 + l1 e^(i phi) + l3 e^(i psi)| = l2` gives two psi for each phi, theta_4 = -psi.

    Source: F. Freudenstein, Trans. ASME 77 (1955), 853.
    """
    l1, l2, l3, l4 = rows("planar_4r", "length")
    circuits = moved("planar_4r").circuits
    phi = of(circuits[0], "theta_1")[0]
    w = l4 + l1 * np.exp(1j * phi)
    psi = angles_with(w.real, w.imag, (l2**2 - l3**2 - np.abs(w) ** 2) / (2 * l3))
    assert each_is_one_of(-psi, [of(c, "theta_4")[0] for c in circuits]).max() < EXACT


def spherical_output(twists: Floats, theta: Floats) -> Floats:
    """Both theta_4 (2, n) of a spherical 4R: the axes 2 and 3, seen from the ground by its two sides, are `twists[1]` apart."""
    a1, a2, a3, a4 = twists
    x, y, z = np.sin(a1) * np.sin(theta), -np.sin(a1) * np.cos(theta), np.cos(a1)
    # axis 2 in the frame of the ground before its twist
    y, z = np.cos(a4) * y - np.sin(a4) * z, np.sin(a4) * y + np.cos(a4) * z
    return angles_with(np.sin(a3) * y, np.sin(a3) * x, np.cos(a2) - np.cos(a3) * z)


def test_spherical_4r_has_its_closed_form() -> None:
    """Source: the spherical law of cosines; C. H. Chiang, Kinematics of spherical mechanisms (1988)."""
    circuits = moved("spherical_4r").circuits
    want = spherical_output(rows("spherical_4r", "twist"), of(circuits[0], "theta_1")[0])
    assert each_is_one_of(want, [of(c, "theta_4")[0] for c in circuits]).max() < EXACT


def test_universal_joint_turns_by_the_law_of_cardan() -> None:
    """`tan(out) = cos(angle of the shafts) tan(in)`, the first arm upright on their plane at zero.

    Source: R. S. Hartenberg and J. Denavit, Kinematic synthesis of linkages (1964).
    """
    cosine = 4 / 5
    sides = []
    for circuit in moved("universal_joint").circuits:
        turn, out = of(circuit, "input_shaft", "output_shaft")
        want = np.arctan2(cosine * np.sin(turn), np.cos(turn))
        side = apart(out[0], want[0]) > 1
        assert apart(out, want + np.pi * side).max() < EXACT
        sides.append(bool(side))
    assert sorted(sides) == [False, True]


# Loops of seven freedoms


def test_rccc_has_the_angles_of_the_spherical_4r_and_slides_that_follow() -> None:
    """Principle of transference: the rotations close alone; then the slides solve three linear equations.

    Source: A. T. Yang and F. Freudenstein, J. Appl. Mech. 31 (1964), 300.
    """
    turns = ("crank", "turn_2", "turn_3", "turn_4")
    bars = [0, 2, 4, 6]
    length, twist = rows("rccc", "length")[bars], rows("rccc", "twist")[bars]
    circuits = moved("rccc").circuits
    want = spherical_output(twist, of(circuits[0], "crank")[0])
    assert each_is_one_of(want, [of(c, "turn_4")[0] for c in circuits]).max() < EXACT
    for circuit in circuits:
        angles = np.array(of(circuit, *turns)).T
        slides = np.array(of(circuit, "slide_2", "slide_3", "slide_4")).T
        for theta, slide in zip(angles, slides, strict=True):
            rotation, along, axes = np.eye(3), np.zeros(3), []
            for i in range(4):
                axes.append(rotation[:, 2])
                rotation = rotation @ about_z(theta[i])
                along = along + length[i] * rotation[:, 0]
                rotation = rotation @ about_x(twist[i])
            assert np.allclose(rotation, np.eye(3), atol=EXACT)
            follow = np.linalg.solve(np.array(axes[1:]).T, -along)
            assert np.abs(slide - follow).max() < 10 * EXACT * length.max()


def about_z(angle: float) -> Floats:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def about_x(angle: float) -> Floats:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


def test_rssp_slides_by_a_quadratic() -> None:
    """The slider B is where a sphere about A meets the line of the slide: two places for each crank angle."""
    crank, place, along = (
        drawn("rssp", "ball_a"),
        drawn("rssp", "ball_b"),
        drawn("rssp", "slider", "axis"),
    )
    coupler = np.linalg.norm(place - crank)
    circuits = moved("rssp").circuits
    alpha = of(circuits[0], "crank")[0]
    from_a = place - turned(np.array([0.0, 0.0, 1.0]), alpha, crank)
    b, c = from_a @ along, (from_a**2).sum(axis=1) - coupler**2
    root = np.sqrt(b**2 - c)
    slides = sorted((of(circuit, "slider")[0] for circuit in circuits), key=lambda s: s[0])
    for got, want in zip(slides, (-b - root, -b + root), strict=True):
        assert np.abs(got - want).max() < EXACT * coupler


def paper_rocker(alpha: Floats) -> Floats:
    """Both angles (2, n) of the rocker in the example of Sun and Zhou, their eq. (8): `|A - B| = L2`, D = 0."""
    M = N = 700.0
    L1, L3 = 250.0, 550.0
    x, y = L1 * np.cos(alpha), L1 * np.sin(alpha)
    squared = (L1 - M) ** 2 + L3**2 + N**2
    return angles_with(y, np.full_like(y, N), ((x - M) ** 2 + y**2 + N**2 + L3**2 - squared) / (2 * L3))


@pytest.mark.parametrize("name", ["rssr", "rssr_press", "rsur"])
def test_the_rocker_of_sun_and_zhou_moves_by_their_equation(name: str) -> None:
    """A universal joint in place of a ball leaves the distance of A and B, and so the rocker's angle, as it is.

    Source: Sun and Zhou, eq. (8).
    """
    circuits = moved(name).circuits
    beta = paper_rocker(of(circuits[0], "crank")[0])
    assert each_is_one_of(beta, [of(c, "rocker")[0] for c in circuits]).max() < EXACT


def test_the_engine_moves_its_piston_by_the_law_of_the_slider_crank() -> None:
    for circuit, way in zip(moved("engine").circuits, (1, -1), strict=True):
        crank = of(circuit, "crank")[0]
        place = 40 * np.cos(crank) + way * np.sqrt(140**2 - (40 * np.sin(crank)) ** 2)
        assert np.abs(of(circuit, "piston")[0] - (place - 180)).max() < 180 * EXACT


def test_seven_r_with_bodies_moves_as_without() -> None:
    for loaded, bare in zip(moved("seven_r_bodies"), moved("seven_r"), strict=True):
        assert np.array_equal(loaded.q, bare.q)


def rscr_outputs(alpha: float) -> Floats:
    """All rocker angles at a crank angle: the ball A, seen from the rocker, stays as far from the cylinder's axis as drawn.

    The condition is of degree two in the cosine and sine of the angle, so of degree four in z = exp(i angle).
    """
    name = "rscr"
    ball, pivot, place = (drawn(name, joint) for joint in ("ball", "rocker", "cylinder"))
    axis, along = drawn(name, "rocker", "axis"), drawn(name, "cylinder", "axis")
    radius = np.linalg.norm(np.cross(ball - place, along))
    arm = turned(drawn(name, "crank", "axis"), np.array([alpha]), ball)[0] - pivot
    fixed = axis * (axis @ arm)
    e, f, g = (np.cross(v, along) for v in (pivot + fixed - place, arm - fixed, np.cross(arm, axis)))
    c2 = (f @ f - g @ g) / 4 - 0.5j * (f @ g)
    c1 = e @ f - 1j * (e @ g)
    c0 = e @ e + (f @ f + g @ g) / 2 - radius**2
    roots = np.roots([c2, c1, c0, c1.conjugate(), c2.conjugate()])
    return np.angle(roots[np.abs(np.abs(roots) - 1) < 1e-7])


def test_rscr_has_the_modes_of_its_quartic() -> None:
    linkage = sb.load("rscr")
    for alpha in (0.3, 1.37, 4.7):
        modes = linkage.assembly_modes(alpha)
        want = np.sort(rscr_outputs(alpha))
        got = np.sort(modes.q[:, circuit_column("rscr", "rocker")])
        assert len(got) == len(want) == (2 if alpha == 4.7 else 4)
        assert apart(got, want).max() < NEARLY
    for circuit in moved("rscr").circuits:
        good = (circuit.status == "ok") & (circuit.condition < 1e3)
        assert good.sum() > SAMPLES / 2
        for alpha, beta in np.array(of(circuit, "crank", "rocker")).T[good]:
            assert apart(rscr_outputs(alpha), beta).min() < NEARLY


def circuit_column(name: str, column: str) -> int:
    return list(sb.load(name).columns).index(column)


def test_the_clemens_coupling_turns_both_shafts_alike() -> None:
    """The ball stays in the plane that mirrors the shafts, so their turns are equal, or half a turn apart.

    Source: K. H. Hunt, J. Eng. Ind. 95 (1973), 455.
    """
    differences = []
    for circuit in moved("five_bar").circuits:
        turn, out = of(circuit, "input_shaft", "output_shaft")
        differences.append(int(apart(out[0], turn[0]) > 1))
        assert apart(out - turn, np.pi * differences[-1]).max() < EXACT
        speed = circuit.dq[:, circuit.columns.index("output_shaft")]
        assert np.abs(speed / (2 * np.pi) - 1).max() < RATE
        assert np.abs(circuit.point(2, (0, 0, 72)).position[:, 0]).max() < EXACT * 100
    assert sorted(differences) == [0, 0, 1, 1]


def test_six_bar_has_the_angles_of_a_spherical_4r_and_a_slide_that_follows() -> None:
    """Three parallel turning joints keep their direction n, and no place moves along n by them.

    So the hinge's direction is as far from n as drawn, which gives the cylinder's turn; and the hinge's place is as
    high along n as drawn, which gives its slide.
    """
    name = "six_bar"
    up, n = drawn(name, "crank", "axis"), drawn(name, "parallel_1", "axis")
    hinge, along = drawn(name, "hinge", "axis"), drawn(name, "cylinder", "axis")
    arm = drawn(name, "hinge") - drawn(name, "cylinder")
    circuits = moved(name).circuits
    alpha = of(circuits[0], "crank")[0]
    n_now = turned(up, alpha, n)
    mean = along * (along @ hinge)
    solutions = angles_with(n_now @ (hinge - mean), n_now @ np.cross(along, hinge), n @ hinge - n_now @ mean)
    turns = [of(c, "cylinder.1")[0] for c in circuits]
    assert each_is_one_of(solutions, turns).max() < EXACT
    for circuit, turn in zip(circuits, turns, strict=True):
        place = turned(along, turn, arm) + drawn(name, "cylinder")
        slide = (n @ drawn(name, "hinge") - (n_now * place).sum(axis=1)) / (n_now @ along)
        assert np.abs(of(circuit, "cylinder.2")[0] - slide).max() < 10 * EXACT * np.linalg.norm(arm)


def test_seven_r_has_the_modes_worked_out_with_forty_digits() -> None:
    """Source: tests/references/seven_r_modes.json."""
    path = REFERENCES / "seven_r_modes.json"
    reference = json.loads(path.read_text(encoding="utf-8"))["modes"]
    linkage = sb.load("seven_r")
    for degrees in {mode["theta1_deg"] for mode in reference}:
        want = np.array([mode["theta"] for mode in reference if mode["theta1_deg"] == degrees])
        got = linkage.assembly_modes(np.radians(degrees)).q
        distance = apart(got[:, None], want).max(axis=2)
        assert sorted(distance.argmin(axis=1)) == list(range(8))
        assert distance.min(axis=1).max() < EXACT


# Overconstrained


def bennett_constant(between: float, other: float) -> float:
    """`tan(theta_1 / 2) tan(theta_2 / 2)` of a Bennett loop: the twist of the link between the two joints, the other twist [rad].

    Source: G. T. Bennett (1903), in the form of classic Denavit-Hartenberg angles.
    """
    return float(np.sin((other + between) / 2) / np.sin((other - between) / 2))


def off_product(first: Floats, second: Floats, constant: float) -> Floats:
    """How far tan(first / 2) tan(second / 2) is from a constant, without the tangents' poles."""
    sines = np.sin(first / 2) * np.sin(second / 2)
    cosines = np.cos(first / 2) * np.cos(second / 2)
    return np.abs(sines - constant * cosines) / np.hypot(1, constant)


def test_bennett_keeps_the_product_of_its_half_tangents() -> None:
    first, second = rows("bennett", "twist")[:2]
    constant = bennett_constant(first, second)
    (circuit,) = moved("bennett").circuits
    t1, t2, t3, t4 = thetas(circuit)
    clear = (np.abs(np.sin(t1)) > 0.1) & (np.abs(np.sin(t2)) > 0.1)
    product = np.tan(t1 / 2) * np.tan(t2 / 2)
    assert clear.sum() > SAMPLES / 2
    assert np.abs(product[clear] / constant - 1).max() < 1e-13
    assert off_product(t1, t2, constant).max() < 1e-13
    assert apart(t1, -t3).max() < EXACT
    assert apart(t2, -t4).max() < EXACT


def test_goldberg_5r_moves_as_the_two_bennetts_it_is_made_of() -> None:
    """Joints 5 and 1 are those of the first loop, 2 and 3 of the second, and the common link ties the two together.

    Source: M. Goldberg, Trans. ASME 65 (1943), 649; Bennett's relation for each of the two loops.
    """
    _, beta, gamma, alpha, _ = rows("goldberg_5r", "twist")
    (circuit,) = moved("goldberg_5r").circuits
    t1, t2, t3, t4, t5 = thetas(circuit)
    assert off_product(t1, t5, bennett_constant(beta, alpha)).max() < EXACT
    assert off_product(t2, t3, bennett_constant(beta, gamma)).max() < EXACT
    assert apart(t3, np.pi - t5).max() < EXACT
    assert apart(t4, np.pi - t1 - t2).max() < EXACT


def test_myard_5r_moves_as_two_bennetts_that_mirror_each_other() -> None:
    """Joints 2 and 3 are those of one loop, 4 and 5 of its mirror image; joint 1 makes up for 3 and 4.

    Source: F. E. Myard, Bull. Soc. Math. France 59 (1931), 183; Bennett's relation with one twist of 90 deg.
    """
    constant = bennett_constant(np.pi / 2, rows("myard_5r", "twist")[0])
    (circuit,) = moved("myard_5r").circuits
    t1, t2, t3, t4, t5 = thetas(circuit)
    assert off_product(t2, t3, constant).max() < EXACT
    assert apart(t5, -t2).max() < EXACT
    assert apart(t4, t3 + np.pi).max() < EXACT
    assert apart(t1, -t3 - t4).max() < EXACT


def walk(name: str, theta: Floats, count: int) -> Floats:
    """The frame (4, 4) after so many links of a loop of R joints, from that of joint 1."""
    length, twist, offset = (rows(name, key) for key in ("length", "twist", "offset"))
    frame = np.eye(4)
    for i in range(count):
        link = np.eye(4)
        link[:3, :3] = about_z(theta[i]) @ about_x(twist[i])
        link[:3, 3] = about_z(theta[i]) @ [length[i], 0, offset[i]]
        frame = frame @ link
    return frame


def test_bricard_line_is_carried_onto_itself_by_a_half_turn() -> None:
    """Opposite joints turn alike, and half of the loop is a half turn about a line.

    A half turn has trace -1 and no displacement along its line. Source: R. Bricard, Leçons de cinématique 2 (1927).
    """
    size = rows("bricard_line", "length").max()
    for circuit in moved("bricard_line").circuits:
        t = thetas(circuit)
        assert apart(t[:3], t[3:]).max() < 10 * EXACT
        for theta in t.T:
            half = walk("bricard_line", theta, 3)
            assert abs(np.trace(half[:3, :3]) + 1) < 10 * EXACT
            # (1 + R) / 2 takes to the part along the line
            along = (np.eye(3) + half[:3, :3]) / 2 @ half[:3, 3]
            assert np.abs(along).max() < 10 * EXACT * size


def test_bricard_plane_is_its_own_mirror_image() -> None:
    """Joints 2 and 6, and 3 and 5, turn by opposite angles, and the axes 1 and 4 lie in one plane.

    Source: R. Bricard, Leçons de cinématique 2 (1927).
    """
    size = rows("bricard_plane", "length").max()
    for circuit in moved("bricard_plane").circuits:
        t = thetas(circuit)
        assert apart(t[1], t[5]).max() < 10 * EXACT
        assert apart(t[2], t[4]).max() < 10 * EXACT
        for theta in t.T:
            half = walk("bricard_plane", theta, 3)
            assert abs(np.cross([0, 0, 1], half[:3, 2]) @ half[:3, 3]) < 10 * EXACT * size


def test_bricard_trihedral_keeps_alternate_axes_in_one_point() -> None:
    """Axes 2, 4 and 6 meet in one point O, so two links tell where on axis k O is: at s_k.

    Seen along axis 1, `-a6 - i s6 = exp(i theta_1) (a1 - i s2)`, and in turn for axes 3 and 5. Each s follows from two
    of the angles, which therefore obey `(a6 + a1 cos t1) sin t3 = (a3 + a2 cos t3) sin t1` and so on.
    Source: R. Bricard, Leçons de cinématique 2 (1927), the trihedral case.
    """
    a = rows("bricard_trihedral", "length")
    (circuit,) = moved("bricard_trihedral").circuits
    t = thetas(circuit)
    for k in (0, 2, 4):
        here, there = t[k], t[(k + 2) % 6]
        before, this, after, beyond = a[k - 1], a[k], a[(k + 1) % 6], a[(k + 2) % 6]
        left = (before + this * np.cos(here)) * np.sin(there)
        right = (beyond + after * np.cos(there)) * np.sin(here)
        assert np.abs(left - right).max() < 10 * EXACT * a.max()


def test_sarrus_platform_goes_straight_and_does_not_turn() -> None:
    """Height of the slider-crank that the first leg is: `l1 sin + sqrt(l2^2 - (e - l1 cos)^2)`, the other way up too.

    Source: P. F. Sarrus, C. R. Acad. Sci. 36 (1853), 1036.
    """
    name = "sarrus"
    base, knee, top = (drawn(name, joint) for joint in ("crank", "knee_1", "platform_1"))
    l1, l2, e = np.linalg.norm(knee - base), np.linalg.norm(top - knee), (top - base)[1]
    upright = np.pi / 2  # of the crank as drawn
    place = np.array(written(name)["point"][0]["at"], dtype=float)
    ways = []
    for circuit in moved(name).circuits:
        crank, knee_1, platform_1 = of(circuit, "crank", "knee_1", "platform_1")
        assert apart(crank + knee_1 + platform_1, 0).max() < EXACT
        assert np.abs(circuit.link_motion(3).velocity).max() < RATE
        rise = circuit.point(3, tuple(place)).position - place
        assert np.abs(rise[:, :2]).max() < 100 * EXACT
        height = top[2] + rise[:, 2]
        ways.append(float(np.sign(height[0])))
        angle = upright + crank
        root = np.sqrt(l2**2 - (e - l1 * np.cos(angle)) ** 2)
        assert np.abs(height - (l1 * np.sin(angle) + ways[-1] * root)).max() < EXACT * l2
    assert sorted(ways) == [-1, -1, 1, 1]


def test_swash_plate_lifts_its_piston_by_the_height_of_the_plate_below_the_knuckle() -> None:
    """The knuckle stays as far above the plate as drawn: normal . (radius, 0, height) = distance, the normal turning."""
    name = "swash_plate"
    knuckle, normal = drawn(name, "knuckle"), drawn(name, "slipper", "axis")
    distance = normal @ knuckle
    for circuit in moved(name).circuits:
        shaft, piston = of(circuit, "shaft", "piston")
        first, second, turn = of(circuit, "slipper.1", "slipper.2", "slipper.3")
        height = (distance - normal[0] * knuckle[0] * np.cos(shaft)) / normal[2]
        assert np.abs(piston - (height - knuckle[2])).max() < EXACT
        # the foot of the knuckle's perpendicular on the plate, by the plate's turn and by the slipper's place
        seen = np.stack([knuckle[0] * np.cos(shaft), -knuckle[0] * np.sin(shaft), height]).T
        foot = drawn(name, "slipper")
        beside = np.linalg.norm(knuckle - distance * normal - foot)
        outward, across = np.array([normal[2], 0.0, -normal[0]]), np.array([0.0, 1.0, 0.0])
        out, along = first + beside * np.cos(turn), second + beside * np.sin(turn)
        want = foot + out[:, None] * outward + along[:, None] * across
        assert np.abs(seen - distance * normal - want).max() < EXACT


def test_screw_drill_turns_its_spindle_by_the_law_of_cosines() -> None:
    """The side from pin to pivot is as drawn + pitch x turns of the thread; the spindle turns against the thread."""
    name = "screw_drill"
    pin, pivot = drawn(name, "pin"), drawn(name, "pivot")
    pitch = next(j["pitch"] for j in written(name)["joint"] if j["name"] == "thread")
    crank, ground, side = np.linalg.norm(pin), np.linalg.norm(pivot), np.linalg.norm(pivot - pin)
    ways = []
    for circuit in moved(name).circuits:
        angle, spindle, thread = of(circuit, "crank", "spindle", "thread")
        # the crank as drawn stands upright on the ground link, and turns towards it
        length = np.sqrt(crank**2 + ground**2 - 2 * crank * ground * np.sin(angle))
        ways.append(float(np.sign(side + pitch * thread[0] / (2 * np.pi))))
        want = (ways[-1] * length - side) * 2 * np.pi / pitch
        assert np.abs(thread - want).max() < EXACT
        assert apart(spindle, -want).max() < EXACT
    assert sorted(ways) == [-1, 1]
