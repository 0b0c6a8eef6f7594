"""What is said of mistakes in bodies, loads and springs of a file: each has its own message with its place."""

import pytest
from test_loading_file import rssr

import sevenbar as sb
from sevenbar.errors import DescriptionError, RequestError


def complaints(tables: str, head: str = "") -> list[str]:
    with pytest.raises(DescriptionError) as caught:
        sb.loads(rssr(tables, head), "f.toml")
    return [line.removeprefix("f.toml: ") for line in str(caught.value).splitlines()]


BODY = "[[body]]\nlink = 2\n"
LOAD = "[[load]]\nlink = 2\n"
SPRING = "[[spring]]\n"
BETWEEN = SPRING + "links = [1, 4]\nat = [[0, 0, 0], [1, 1, 1]]\n"
KNOWN = (
    "allowed: g, kg, t, oz, lb, mN, N, kN, lbf, um, mm, cm, m, in, ft, s, ms, min, rad, deg; "
    "give a mass, as in 12, '12 kg' or '250 g'"
)


@pytest.mark.parametrize(
    ("tables", "messages"),
    [
        ("[[body]]\nmass = 1\nsolid = 'rod'\n", ["body[1].link: is missing; needed here: link"]),
        (
            "[[body]]\nlink = 7\nmass = 1\nsolid = 'rod'\n",
            ["body[1].link: 7 is not a link; give 1 to 4, the last is the ground"],
        ),
        (
            "[[body]]\nlink = 4\nmass = 1\nsolid = 'rod'\n",
            ["body[1].link: link 4 is the ground; a body there moves nothing, leave it out, or give 1 to 3"],
        ),
        (
            "[[body]]\nlink = 0\nmass = 1\nsolid = 'rod'\n",
            ["body[1].link: 0 is not a link; give its number, counted from 1"],
        ),
        (
            BODY + "centre = [0, 0, 0]\n",
            ["body[1].mass: is missing; give one, or solid = 'drawn' for the drawn solids in steel"],
        ),
        (BODY + "mass = 0\nsolid = 'rod'\n", ["body[1].mass: 0 is not a mass; give a number > 0"]),
        (BODY + "mass = '-2 kg'\nsolid = 'rod'\n", ["body[1].mass: -2.0 is not a mass; give a number > 0"]),
        (
            BODY + "mass = '2 kp'\nsolid = 'rod'\n",
            [f"body[1].mass: '2 kp': 'kp' is not a unit known here; {KNOWN}"],
        ),
        (
            BODY + "mass = '2 mm'\nsolid = 'rod'\n",
            ["body[1].mass: '2 mm': 'mm' is not a unit of mass; give a mass, as in 12, '12 kg' or '250 g'"],
        ),
        (BODY + "mass = 2\n", ["body[1].centre: is missing; give three lengths, or solid"]),
        (
            BODY + "mass = 2\nsolid = 'rod'\ncentre = [1, 2, 3]\n",
            ["body[1].solid: rod has its own centre and inertia; leave both out"],
        ),
        (
            BODY + "mass = 2\nsolid = 'point'\ncentre = [1, 2, 3]\ninertia = [1, 1, 1, 0, 0, 0]\n",
            ["body[1].solid: a point has no inertia about itself; leave inertia out"],
        ),
        (
            BODY + "mass = 2\nsolid = 'bar'\n",
            ["body[1].solid: 'bar' is not a solid; allowed: rod, cylinder, box, point, drawn"],
        ),
        (
            BODY + "mass = 2\ncentre = [1, 2, 3]\ninertia = [1, 2, 4, 0, 0, 0]\n",
            [
                "body[1].inertia: principal moments 1, 2, 4: no body has one greater than the sum of the others; "
                "give the entries of the tensor about the centre"
            ],
        ),
        (
            BODY + "mass = 2\ncentre = [1, 2, 3]\ninertia = [1, 1, 1, 2, 0, 0]\n",
            [
                "body[1].inertia: principal moments -1, 1, 3: one is negative; "
                "give the entries of the tensor about the centre"
            ],
        ),
        (
            BODY + "mass = 2\ncentre = [1, 2, 3]\ninertia = [1, 2, 3]\n",
            [
                "body[1].inertia: [1, 2, 3] is not an inertia; give six numbers, xx yy zz yz xz xy of the "
                "tensor, or of a planar linkage one, about the axis across its plane"
            ],
        ),
        (
            BODY + "mass = 2\nsolid = 'rod'\ncenter = 3\n",
            [
                "body[1].center: is not known here; did you mean 'centre'? "
                "allowed: link, mass, centre, inertia, solid, density, diameter, bore, ends, size, along, side, name"
            ],
        ),
        ("[body]\nlink = 2\nmass = 2\nsolid = 'rod'\n",
         ["body: {'link': 2, 'mass': 2, 'solid': 'rod'} does not fit here; write [[body]] before each one"]),
        ("[[forces]]\ngravity = [0, 0, 1]\n",
         ["forces: [{'gravity': [0, 0, 1]}] is a list; write [forces], once"]),
        (
            "[forces]\ngravity = 9.81\n",
            ["forces.gravity: 9.81 is not a point or direction; give three numbers, as in [0, 0, 1]"],
        ),
        (
            "[forces]\ngravity = ['3 m/s', 0, 0]\n",
            [
                "forces.gravity: '3 m/s': 'm/s' is not a unit of acceleration; "
                "give an acceleration, as in 12, '12 m/s^2' or '9810 mm/s^2'"
            ],
        ),
        (
            "[forces]\nmass_unit = 'stone'\n",
            ["forces.mass_unit: 'stone' is not a unit known here; allowed: g, kg, t, oz, lb"],
        ),
        (LOAD, ["load[1].force: is missing; give a force [N] at a point, or a torque [N m]"]),
        (
            LOAD + "force = [0, 0, 1]\n",
            ["load[1].at: is missing; give the point at which the force acts"],
        ),
        (
            "[[load]]\nlink = 4\ntorque = [0, 0, 1]\n",
            ["load[1].link: link 4 is the ground; a load on it moves nothing, leave it out, or give 1 to 3"],
        ),
        (
            LOAD + "torque = [0, 0, '1 N']\n",
            ["load[1].torque: '1 N': 'N' is not a unit of torque; give a torque, as in 12, '12 N m' or '300 N mm'"],
        ),
        (
            LOAD + "torque = [0, 0, 1]\naxes = 'body'\n",
            ["load[1].axes: 'body' is not a choice of axes; allowed: ground, link"],
        ),
        (
            LOAD + "torque = [0, 0, 1]\nbetween = [30, 120]\ntable = [[0, 0], [30, 1]]\n",
            ["load[1].table: a load has one of between and table"],
        ),
        (
            LOAD + "torque = [0, 0, 1]\nbetween = 30\n",
            ["load[1].between: 30 is not a range of the input; give two values, as in [30, 120]"],
        ),
        (
            LOAD + "torque = [0, 0, 1]\nbetween = ['3 mm', 4]\n",
            [
                "load[1].between: '3 mm': is a length where an angle belongs; "
                "give an angle, as in 30, '30deg' or 'pi/6'"
            ],
        ),
        (
            LOAD + "torque = [0, 0, 1]\nbetween = [30, 30]\n",
            ["load[1].between: give two different values of the input"],
        ),
        (
            LOAD + "torque = [0, 0, 1]\ntable = [[30, 0], [0, 1]]\n",
            ["load[1].table: give as many factors as inputs, two or more, inputs rising"],
        ),
        (
            LOAD + "torque = [0, 0, 1]\ntable = [30, 0]\n",
            [
                "load[1].table: [30, 0] is not a table; give the name of a CSV file, or rows of input and factor, "
                "as in [[0, 0], [30, 1], [60, 0]]"
            ],
        ),
        (
            LOAD + "torque = [0, 0, 1]\ntable = 'none.csv'\n",
            [
                "load[1].table: none.csv: no such file; "
                "give the path of a table of the factor of a load along the input"
            ],
        ),
        (SPRING + "stiffness = 1\n",
         ["spring[1].links: a spring is between two links, or in one joint; give one of these"]),
        (BETWEEN, ["spring[1].stiffness: is missing; give stiffness or damping"]),
        (
            BETWEEN + "stiffness = 1\nfree = 3\n",
            ["spring[1].free: does not belong to a spring between links; give its length there as length"],
        ),
        (
            SPRING + "links = [1, 7]\nat = [[0, 0, 0], [1, 1, 1]]\nstiffness = 1\n",
            ["spring[1].links[2]: 7 is not a link; give 1 to 4, the last is the ground"],
        ),
        (
            SPRING + "links = [2, 2]\nat = [[0, 0, 0], [1, 1, 1]]\nstiffness = 1\n",
            ["spring[1].links: (2, 2) are not two different links"],
        ),
        (SPRING + "links = [1, 4]\nstiffness = 1\n", ["spring[1].at: give two points, one on each link"]),
        (
            SPRING + "links = [1]\nat = [[0, 0, 0], [1, 1, 1]]\nstiffness = 1\n",
            ["spring[1].links: [1] are not two; give one for each of the two links"],
        ),
        (
            SPRING + "joint = 'crank'\nstiffness = 1\nlength = 3\n",
            ["spring[1].length: does not belong to a spring in a joint; give its value there as free"],
        ),
        (
            SPRING + "joint = 'crank'\nlinks = [1, 2]\nstiffness = 1\n",
            ["spring[1].links: does not belong to a spring in a joint; leave it out"],
        ),
        (
            SPRING + "joint = 'cranck'\nstiffness = 1\n",
            [
                "spring[1].joint: no joint 'cranck'; did you mean 'crank'? "
                "this linkage has crank, ball_a, ball_b, rocker"
            ],
        ),
        (
            SPRING + "joint = 'ball_a.1'\nstiffness = 1\n",
            ["spring[1].joint: joint 'ball_a' is a ball; give a joint with one freedom: crank, rocker"],
        ),
        (
            SPRING + "joint = 'crank'\nstiffness = '1 N/mm'\n",
            [
                "spring[1].stiffness: '1 N/mm': 'N/mm' is not a unit of stiffness of a turn; "
                "give a stiffness of a turn, as in 12, '12 N m/rad' or '20 N mm/deg'"
            ],
        ),
        (
            SPRING + "joint = 'crank'\ndamping = -1\n",
            ["spring[1].damping: -1.0 feeds the motion; give one >= 0"],
        ),
        (
            BODY + "mass = 0\nsolid = 'rod'\n" + LOAD + SPRING + "joint = 'ball_b'\nstiffness = 1\n",
            [
                "body[1].mass: 0 is not a mass; give a number > 0",
                "load[1].force: is missing; give a force [N] at a point, or a torque [N m]",
                "spring[1].joint: joint 'ball_b' is a ball; give a joint with one freedom: crank, rocker",
            ],
        ),
    ],
)  # fmt: skip
def test_each_mistake_has_its_own_message(tables, messages):
    assert complaints(tables) == messages


def test_a_key_of_another_table_is_sent_home():
    assert complaints("", "gravity = [0, 0, -9.8]") == [
        "gravity: is a key of [forces]; write it below that head"
    ]
    assert complaints("", "stiffness = 3") == ["stiffness: is a key of [[spring]]; write it below that head"]


@pytest.mark.parametrize("body", [1.2, "rod", None, [sb.Body(1, solid="rod"), 3]])
def test_a_mass_alone_is_no_body(body):
    with pytest.raises(RequestError, match=r"bodies\[2\]: .* is not a body; give one, as in sevenbar.Body"):
        sb.load("rssr").loaded(bodies={2: body})


@pytest.mark.parametrize("link", [True, "2", 2.5, None])
def test_a_link_in_python_is_a_whole_number(link):
    with pytest.raises(RequestError, match=r"bodies: link .* is not a link; give 1 to 3"):
        sb.load("rssr").loaded(bodies={link: sb.Body(1, solid="rod")})
