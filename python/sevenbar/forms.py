"""From a checked description to a linkage: the RSSR paper's dimensions, or joints as drawn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from sevenbar.errors import DescriptionError, NotCoveredError, Problem, RequestError
from sevenbar.linkage import Drive, Joint, Linkage, Point, inverse, pose
from sevenbar.motion import Floats

if TYPE_CHECKING:
    from sevenbar.schema import JointForm, LinkageForm, RssrForm

#: Below this share of the size of a drawn pose a link has no length.
NO_LENGTH = 1e-12


def rssr(
    M: float,
    N: float,
    L1: float,
    L3: float,
    D: float = 0.0,
    L2: float | None = None,
    *,
    name: str = "RSSR",
    length_unit: str = "mm",
    speed: float | str = 1.0,
) -> Linkage:
    """The RSSR in the layout of Sun and Zhou: crank about z at height N, rocker about x at (M, D, 0).

    `A = (L1 cos alpha, L1 sin alpha, N)`, `B = (M, D + L3 cos beta, L3 sin beta)`, `|A - B| = L2`; lengths
    in `length_unit`. L2 left out is `|A1 B1|`, `L2^2 = (L1 - M)^2 + L3^2 + N^2`. Raises `DescriptionError`
    with all that is wrong.

        >>> import sevenbar as sb
        >>> sb.rssr(M=700, N=700, L1=250, L3=550, D=0).motion().motion_type
        'crank-rocker'

    Source: Sun and Zhou, Figure 2, eq. (5) to (7).
    """
    from sevenbar import schema

    dimensions = {"M": M, "N": N, "L1": L1, "L3": L3, "D": D}
    if L2 is not None:
        dimensions["L2"] = L2
    raw = {
        "format": 1,
        "name": name,
        "length_unit": length_unit,
        "drive": {"speed": speed},
        "rssr": {key: _plain(value) for key, value in dimensions.items()},
    }
    return from_form(schema.check(raw))


def from_axes(
    joints: Sequence[Mapping[str, Any]],
    *,
    name: str = "linkage",
    length_unit: str = "mm",
    speed: float | str = 1.0,
    points: Sequence[Mapping[str, Any]] = (),
) -> Linkage:
    """A linkage from its joints as drawn in one assembled pose, in loop order: kind, point, direction.

    Each joint is a mapping with `kind`, `at` (three coordinates), `axis` (three numbers; none for S), and
    perhaps `name`. Link i lies between joints i and i + 1, the last is the ground.

        >>> import sevenbar as sb
        >>> linkage = sb.from_axes([
        ...     {"kind": "R", "at": (0, 0, 700), "axis": (0, 0, 1)},
        ...     {"kind": "S", "at": (250, 0, 700)},
        ...     {"kind": "S", "at": (700, 550, 0)},
        ...     {"kind": "R", "at": (700, 0, 0), "axis": (1, 0, 0)},
        ... ])
        >>> linkage.motion().motion_type
        'crank-rocker'
    """
    from sevenbar import schema

    raw = {
        "format": 1,
        "name": name,
        "length_unit": length_unit,
        "drive": {"speed": speed},
        "joint": _plain(joints),
        "point": _plain(points),
    }
    return from_form(schema.check(raw))


def _plain(value: Any) -> Any:
    """Arrays and NumPy numbers as the lists and numbers that a file would hold."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, Mapping):
        return {key: _plain(v) for key, v in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    return value


def from_form(form: LinkageForm, source: str = "") -> Linkage:
    """The linkage that a checked description tells of."""
    if form.rssr is not None:
        linkage = _from_dimensions(form.rssr)
    elif form.joint is not None:
        linkage = _from_drawing(form.joint, source)
    else:
        raise NotCoveredError(
            f"{_prefix(source)}link: Denavit-Hartenberg rows are not analysed by this version; "
            "it takes [rssr] or [[joint]]"
        )
    points = linkage.points + tuple(Point(p.name, p.link, p.at) for p in form.point)
    drive = form.drive
    try:
        _, input_name, output_name = linkage.sides(drive.joint, drive.output)
    except RequestError as error:
        place, message = str(error).replace("input:", "joint:", 1).split(": ", 1)
        raise DescriptionError([Problem(f"drive.{place}", message)], source) from None
    return replace(
        linkage,
        name=form.name,
        length_unit=form.length_unit,
        points=points,
        drive=Drive(input_name, output_name, drive.speed),
    )


def _prefix(source: str) -> str:
    return f"{source}: " if source else ""


def _from_dimensions(form: RssrForm) -> Linkage:
    base = pose(np.eye(3), [0.0, 0.0, form.N])
    # joint 4 turns the ground against the rocker, about -x, so that its value is the paper's beta
    ground = pose([[0, 0, -1], [-1, 0, 0], [0, 1, 0]], [form.M, form.D, 0.0])
    links = np.stack(
        [
            pose(np.eye(3), [form.L1, 0.0, 0.0]),
            pose(np.eye(3), [form.coupler, 0.0, 0.0]),
            pose(np.diag([1.0, -1.0, -1.0]), [form.L3, 0.0, 0.0]),
        ]
    )
    from sevenbar.schema import RSSR_JOINTS

    return Linkage(
        name="RSSR",
        joints=tuple(Joint(kind, name) for name, kind in RSSR_JOINTS),
        base=base,
        ground=ground,
        links=links,
        point_frames=np.stack([np.eye(4)] * 4),
        drive=Drive("crank", "rocker"),
        points=(Point("A", 1, (form.L1, 0.0, 0.0)), Point("B", 3, (0.0, 0.0, 0.0))),
        dimensions={"M": form.M, "N": form.N, "L1": form.L1, "L2": form.coupler, "L3": form.L3, "D": form.D},
    )


def _from_drawing(forms: tuple[JointForm, ...], source: str) -> Linkage:
    kinds = " ".join(form.kind for form in forms)
    names = [form.name or f"theta_{i}" for i, form in enumerate(forms, 1)]
    if kinds != "R S S R":
        raise NotCoveredError(
            f"{_prefix(source)}joint: a loop {kinds or 'without joints'} is not analysed by this version; "
            "it takes R S S R, in this order"
        )
    crank, ball_a, ball_b, rocker = (np.array(form.at) for form in forms)
    base = pose(_frame_about(forms[0].axis, ball_a - crank), crank)
    ground = pose(_frame_about(forms[3].axis, ball_b - rocker), rocker)
    size = max(
        np.linalg.norm(ball_a - crank), np.linalg.norm(ball_b - ball_a), np.linalg.norm(ball_b - rocker)
    )
    to_a, to_b = (inverse(base) @ [*ball_a, 1.0])[:2], (inverse(ground) @ [*ball_b, 1.0])[:2]
    arms = ((2, np.hypot(*to_a), names[0]), (3, np.hypot(*to_b), names[3]))
    problems = [
        Problem(
            f"joint[{i}].at",
            f"{list(forms[i - 1].at)} lies on the axis of {axis}; the link between has no length",
        )
        for i, arm, axis in arms
        if not arm > NO_LENGTH * size
    ]
    if not np.linalg.norm(ball_b - ball_a) > NO_LENGTH * size:
        problems.append(
            Problem("joint[3].at", f"{list(forms[2].at)} is the place of joint[2]; the coupler has no length")
        )
    if problems:
        raise DescriptionError(problems, source)
    at_a, at_b = pose(np.eye(3), ball_a), pose(np.eye(3), ball_b)
    links = np.stack([inverse(base) @ at_a, inverse(at_a) @ at_b, inverse(at_b) @ ground])
    return Linkage(
        name="linkage",
        joints=tuple(Joint(form.kind, name) for form, name in zip(forms, names, strict=True)),
        base=base,
        ground=ground,
        links=links,
        point_frames=np.stack([inverse(base), inverse(at_a), inverse(at_b), np.eye(4)]),
        drive=Drive(names[0], names[3]),
        points=(Point("A", 1, forms[1].at), Point("B", 3, forms[2].at)),
    )


def _frame_about(axis: npt.ArrayLike | None, towards: Floats) -> Floats:
    """Columns x, y, z: z along the axis, x across it towards a place (any where that lies on the axis)."""
    direction = np.asarray(axis, dtype=np.float64)
    z = direction / np.linalg.norm(direction)
    across = towards - (towards @ z) * z
    if np.linalg.norm(across) <= NO_LENGTH * np.linalg.norm(towards):
        across = np.eye(3)[np.argmin(np.abs(z))]
        across = across - (across @ z) * z
    x = across / np.linalg.norm(across)
    return np.column_stack([x, np.cross(z, x), z])
