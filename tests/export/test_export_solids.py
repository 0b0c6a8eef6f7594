"""The bodies of a linkage as meshes and CAD: read back from the files by trimesh and build123d."""

import math
from functools import cached_property
from itertools import combinations, product

import numpy as np
import pytest
import trimesh

import sevenbar as sb
from gallery_sample import FEW, sampled
from sevenbar.errors import OutputError
from sevenbar.export import export

MILLIMETRES = {"mm": 1.0, "in": 25.4}


def step_parts(path):
    """The parts of a STEP assembly by name."""
    import build123d  # takes seconds

    return {part.label: part for part in build123d.import_step(path).children}


def bores(part):
    """Axes (point, direction) of the cylindrical holes of a part, and their radii."""
    from build123d import GeomType

    found = []
    for face in part.faces().filter_by(GeomType.CYLINDER):
        axis = face.axis_of_rotation
        point, along = np.array(tuple(axis.position)), np.array(tuple(axis.direction))
        middle = np.array(tuple(face.position_at(0.5, 0.5)))
        outward = middle - point - ((middle - point) @ along) * along
        # the face of a hole looks towards its axis
        if np.array(tuple(face.normal_at(0.5, 0.5))) @ outward < 0:
            found.append((point, along, face.radius))
    return found


def off_line(one, two, size):
    """How far two axes are from being one [share of size]: aside, and over the size by their angle."""
    (p, a, *_), (q, b, *_) = one, two
    return (np.linalg.norm((q - p) - ((q - p) @ a) * a) + size * np.linalg.norm(np.cross(a, b))) / size


def joint_lines(linkage, circuit, row):
    """A line of each joint, from points and turns of the links as the motion gives them."""
    lines = []
    for i in range(len(linkage.joints)):
        if i == 0:
            frame = linkage.base
        else:
            own = np.linalg.inv(linkage.point_frames[i - 1])[:3, 3]
            origin = circuit.point(i, tuple(own)).position[row]
            turn = circuit.link_motion(i).rotation[row]
            frame = np.eye(4)
            frame[:3, :3], frame[:3, 3] = turn, origin
            frame = frame @ linkage.links[i - 1]
        lines.append((frame[:3, 3], frame[:3, 2]))
    return lines


class Exported:
    """A linkage of the gallery with its files, each written and read once."""

    def __init__(self, name, folder):
        self.name, self.folder = name, folder
        self.linkage = sb.load(name)
        self.motion = self.linkage.motion(90)

    @cached_property
    def solids(self):
        """The parts of the STEP file by name."""
        export(self.motion, "step", self.folder / "a.step")
        return step_parts(self.folder / "a.step")

    @cached_property
    def meshes(self):
        """The parts of the GLB file by name."""
        export(self.motion, "glb", self.folder / "a.glb")
        return loaded_glb(self.folder / "a.glb")[1]


# a parameter of the module: tests of one linkage follow one another, in one process
@pytest.fixture(scope="module", params=sampled(FEW))
def exported(request, tmp_path_factory):
    return Exported(request.param, tmp_path_factory.mktemp(request.param))


def test_step_holds_sound_solids_whose_holes_are_in_line(exported):
    linkage, motion, parts = exported.linkage, exported.motion, exported.solids
    count = len(linkage.joints)
    links = [f"link_{k}" for k in range(1, count)] + ["ground"]
    shafts = {f"shaft_{joint.name}" for joint in linkage.joints if joint.kind in "RPCH"}
    assert set(links) | shafts <= set(parts)
    for part in parts.values():
        assert part.is_valid
        assert len(part.solids()) == 1
        assert part.volume > 0
    circuit = motion.circuits[0]
    rocks = circuit.input_range is not None
    scale = MILLIMETRES[linkage.length_unit]
    size = scale * circuit.size
    for i, joint in enumerate(linkage.joints):
        if joint.kind not in "RCH":
            continue
        pairs = product(bores(parts[links[i - 1]]), bores(parts[links[i]]))
        apart, one = min(((off_line(a, b, size), a) for a, b in pairs), key=lambda found: found[0])
        assert apart < 1e-9
        if not rocks:
            # and where the motion has the joint, in the first pose
            point, along = joint_lines(linkage, circuit, 0)[i]
            assert off_line((scale * point, along), one, size) < 1e-9


def test_the_balls_and_bores_of_the_paper_s_linkage_are_where_it_puts_them(tmp_path):
    alpha = 0.5
    from build123d import GeomType
    from OCP.BRepAdaptor import BRepAdaptor_Surface

    linkage = sb.load("rssr")
    export(linkage, "step", tmp_path / "a.step", at=alpha, circuit=1)
    parts = step_parts(tmp_path / "a.step")
    beta = linkage.output([alpha]).position[1, 0]
    ball_a = np.array([250 * math.cos(alpha), 250 * math.sin(alpha), 700.0])
    ball_b = np.array([700.0, 550 * math.cos(beta), 550 * math.sin(beta)])

    def centres(part):
        spheres = part.faces().filter_by(GeomType.SPHERE)
        places = [BRepAdaptor_Surface(face.wrapped).Sphere().Location() for face in spheres]
        return [np.array([place.X(), place.Y(), place.Z()]) for place in places]

    for link, ball in (("link_1", ball_a), ("link_2", ball_a), ("link_2", ball_b), ("link_3", ball_b)):
        assert min(np.linalg.norm(centre - ball) for centre in centres(parts[link])) < 1e-9 * 1000
    for link, point, along in (
        ("link_1", (0, 0, 700), (0, 0, 1)),
        ("link_3", (700, 0, 0), (1, 0, 0)),
    ):
        (bore,) = bores(parts[link])
        assert off_line((np.array(point, dtype=float), np.array(along, dtype=float)), bore, 1000.0) < 1e-9
    assert len(bores(parts["ground"])) == 2


def loaded_glb(path):
    """The parts of a GLB in report coordinates [m], by name."""
    scene = trimesh.load(path, process=False)
    upright = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1.0]])
    found = {}
    for node in scene.graph.nodes_geometry:
        frame, geometry = scene.graph[node]
        mesh = scene.geometry[geometry].copy()
        mesh.apply_transform(upright @ frame)
        found[geometry] = mesh
    return scene, found


def test_glb_holds_watertight_parts_of_the_cad_s_volume(exported):
    from build123d import CenterOf

    meshes, solids = exported.meshes, exported.solids
    assert set(meshes) == set(solids)
    for part, mesh in meshes.items():
        assert mesh.is_watertight
        assert mesh.body_count == 1
        # 48 flats round a rod take 0.3 % of it, and the same of a hole
        assert mesh.volume * 1e9 == pytest.approx(solids[part].volume, rel=0.015)
        middle = np.array(tuple(solids[part].center(CenterOf.MASS)))
        assert np.linalg.norm(1000 * mesh.center_mass - middle) < 2e-3 * np.linalg.norm(1000 * mesh.extents)


def test_glb_s_nodes_are_the_links_in_their_frames(tmp_path):
    linkage = sb.load("seven_r")
    motion = linkage.motion(24)
    export(motion, "glb", tmp_path / "a.glb", circuit=2)
    scene, _ = loaded_glb(tmp_path / "a.glb")
    circuit = motion.circuits[2]
    upright = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    for link in range(1, 7):
        frame, _ = scene.graph[f"link_{link}"]
        own = tuple(np.linalg.inv(linkage.point_frames[link - 1])[:3, 3])
        np.testing.assert_allclose(
            1000 * upright @ frame[:3, 3], circuit.point(link, own).position[0], atol=1e-9
        )
        np.testing.assert_allclose(upright @ frame[:3, :3], circuit.link_motion(link).rotation[0], atol=1e-12)


def test_stl_is_one_file_in_the_linkage_s_unit_or_a_folder_of_parts(tmp_path):
    motion = sb.load("rssr").motion(24)
    assert export(motion, "stl", tmp_path / "all.stl") == [tmp_path / "all.stl"]
    whole = trimesh.load(tmp_path / "all.stl")
    files = export(motion, "stl", tmp_path / "parts")
    assert {file.name for file in files} == {
        "link_1.stl", "link_2.stl", "link_3.stl", "ground.stl", "shaft_crank.stl", "shaft_rocker.stl"
    }  # fmt: skip
    parts = [trimesh.load(file) for file in files]
    assert all(part.is_watertight and part.volume > 0 for part in parts)
    assert whole.body_count == len(parts)
    assert whole.is_watertight
    assert whole.volume == pytest.approx(sum(part.volume for part in parts), rel=1e-5)
    with pytest.raises(OutputError, match=r"parts/\w+\.stl: exists already"):
        export(motion, "stl", tmp_path / "parts")
    assert len(export(motion, "stl", tmp_path / "parts", force=True)) == 6


#: Which parts of the gallery still meet in the first pose: crossing links, and a ball's arm at its socket's rim.
MEET = {
    "bricard_plane": {("link_2", "link_5"), ("link_1", "link_2")},
    "myard_5r": {("link_2", "link_3"), ("link_2", "link_4"), ("link_3", "link_4")},
    "rssp": {("link_1", "link_2")},
    # a quarter of a per cent, where the rod passes the sleeve
    "six_bar": {("link_5", "shaft_cylinder")},
}


def test_parts_do_not_run_into_each_other(exported):
    parts = exported.meshes
    met = set()
    for one, two in combinations(sorted(parts), 2):
        a, b = parts[one], parts[two]
        if (a.bounds[0] > b.bounds[1]).any() or (b.bounds[0] > a.bounds[1]).any():
            continue
        common = trimesh.boolean.intersection([a, b], engine="manifold")
        if not common.is_empty and abs(common.volume) > 1e-4 * min(a.volume, b.volume):
            met.add((one, two))
    assert met <= MEET.get(exported.name, set())


@pytest.mark.parametrize("unit", ["um", "m", "ft"])
def test_any_length_unit_gives_the_same_shape(unit, tmp_path):
    metres = {"um": 1e-6, "m": 1.0, "ft": 0.3048}[unit]
    text = f'format = 1\nlength_unit = "{unit}"\n[rssr]\nM = 7\nN = 7\nL1 = 2.5\nL3 = 5.5\nD = 0\n'
    export(sb.loads(text), "glb", tmp_path / "a.glb")
    export(sb.rssr(M=7, N=7, L1=2.5, L3=5.5, D=0), "glb", tmp_path / "b.glb")
    _, one = loaded_glb(tmp_path / "a.glb")
    _, two = loaded_glb(tmp_path / "b.glb")
    for part in one:
        assert one[part].is_watertight
        ratio = one[part].volume / two[part].volume
        assert ratio == pytest.approx((metres / 1e-3) ** 3, rel=1e-3)
