"""The Rust core: arrays in, values of arrays out. Columns are by their number."""

from collections.abc import Callable, Sequence
from typing import Literal, final

import numpy as np
import numpy.typing as npt

__all__ = [
    "AGREE",
    "NO_SIZE",
    "Acting",
    "Carried",
    "CoreError",
    "Course",
    "Followed",
    "Loop",
    "LoopBatch",
    "LoopWord",
    "Net",
    "NetFollowed",
    "NetParts",
    "NetRows",
    "Numbers",
    "Product",
    "RawCircuit",
    "RawCount",
    "RawFound",
    "RawMeasures",
    "RawMotion",
    "RawSearch",
    "RawTally",
    "Rows",
    "Rssr",
    "RssrBatch",
    "Survey",
    "WorkStop",
    "__version__",
    "biconnected_parts",
    "classify_rssr",
    "driven",
    "measure_loops",
    "measure_rssr",
    "net_blocks",
    "piecewise",
    "reactions",
    "simd_level",
    "survey_figures",
]

_Floats = npt.NDArray[np.float64]
_Integers = npt.NDArray[np.int64]

#: The lowest value, the input there, the highest value, the input there.
_Ends = tuple[float, float, float, float]

#: The closure error [rad, or parts of the size] up to which redundant constraints agree.
AGREE: float
#: Below this share of the way from the origin to a loop, its size is rounding.
NO_SIZE: float
__version__: str

class CoreError(ValueError):
    """A request that the core cannot take."""

@final
class WorkStop:
    """Stops the work of the core from another thread.

    Within a `with` block of it the core's calls of this thread raise KeyboardInterrupt once `stop()` was
    called.
    """

    def __new__(cls) -> WorkStop: ...
    def stop(self) -> None:
        """Ends what is at work, and all that follows."""

    @property
    def stopped(self) -> bool:
        """Whether it was stopped."""

    def __enter__(self) -> WorkStop: ...
    def __exit__(self, kind: object, value: object, traceback: object) -> None: ...

@final
class Rssr:
    """The RSSR in closed form."""

    def __new__(cls, base: _Floats, ground: _Floats, links: _Floats) -> Rssr: ...
    @property
    def lengths(self) -> list[float]: ...
    @property
    def size(self) -> float: ...
    @property
    def has_free_side(self) -> bool: ...
    def outputs(
        self,
        inputs: _Floats,
        order: int,
        input: str,
        speed: float,
        law: tuple[_Floats, ...] | None = None,
    ) -> list[_Floats]: ...
    def assembly_modes(self, theta: float, input: str) -> tuple[_Floats, _Floats]: ...
    def motion(self, input: str, samples: int, speed: float, law: _Floats | None = None) -> RawMotion: ...
    def point(self, link: int, at: _Floats, crank: _Floats, rocker: _Floats) -> _Floats: ...

@final
class Loop:
    """A single closed loop of R, P, H and S joints."""

    def __new__(
        cls,
        letters: str,
        advances: _Floats,
        base: _Floats,
        ground: _Floats,
        links: _Floats,
        agree: float = ...,
        drawn: _Floats | None = None,
    ) -> Loop: ...
    @property
    def size(self) -> float: ...
    @property
    def freedoms(self) -> int: ...
    @property
    def can_be_driven(self) -> bool: ...
    @property
    def idle(self) -> list[tuple[str, int, int]]: ...
    @property
    def spin_axes(self) -> list[tuple[int, list[float]]]: ...
    def assembly_modes(
        self, column: int, value: float
    ) -> tuple[_Floats, _Floats, Literal["algebraic", "searched"], list[float], list[float] | None]: ...
    def mobility(self, column: int) -> RawFound | None: ...
    def motion(
        self,
        input: int,
        output: int,
        samples: int,
        speed: float,
        law: _Floats | None = None,
        keep: bool = True,
    ) -> RawMotion: ...
    def rows(self, course: Course) -> tuple[_Floats, _Integers, _Integers, _Floats, _Floats, Rows]: ...
    def circuit_through(
        self, pose: _Floats, input: int, output: int, samples: int, speed: float, law: _Floats | None = None
    ) -> tuple[RawCircuit, Followed] | float | list[int] | None: ...
    def circuit_again(
        self,
        followed: Followed,
        input: int,
        output: int,
        samples: int,
        speed: float,
        law: _Floats | None = None,
    ) -> RawCircuit: ...
    def point(self, rows: Rows, link: int, at: _Floats) -> _Floats: ...

#: Its normal, each joint's letter with its place or direction, the steps of its links and those it hangs at.
_RawDyad = tuple[
    tuple[float, float, float],
    Sequence[tuple[str, tuple[float, float, float]]],
    tuple[int, int],
    tuple[int | None, int | None],
]

#: A planar block: its normal, the steps of its links, each joint's letter, its place and its direction (of a
#: rod two places), and the steps of its two links: R P, K of a pin of the first in a slot of the second, L of
#: a rod.
_RawBlock = tuple[
    tuple[float, float, float],
    Sequence[int],
    Sequence[
        tuple[str, tuple[float, float, float], tuple[float, float, float], tuple[int | None, int | None]]
    ],
]

#: A link in space: its steps, the rows of each of its joints and rods (the kind, the steps of the two links,
#: the vectors, a number), and its legs: their steps, the place of the ball, the steps of its two links.
_RawBody = tuple[
    Sequence[int],
    Sequence[
        Sequence[
            tuple[
                str,
                tuple[int | None, int | None],
                tuple[tuple[float, float, float], tuple[float, float, float]],
                float,
            ]
        ]
    ],
    Sequence[tuple[Sequence[int], tuple[float, float, float], tuple[int | None, int | None]]],
]

#: One loop: the letters of its joints, the advance of each, its place and direction; each link by how many
#: joints lead to it and the steps of its two sides; the steps of the known links; the point in which all axes
#: meet; the steps of joints that have several.
_RawLoop = tuple[
    str,
    Sequence[float],
    Sequence[tuple[tuple[float, float, float], tuple[float, float, float]]],
    Sequence[tuple[int, tuple[int, int]]],
    tuple[int | None, int | None],
    tuple[float, float, float] | None,
    Sequence[Sequence[int]],
]

@final
class NetRows:
    """The rows of a circuit of a net, which makes points of them; pickled as their numbers."""

    def __new__(cls, numbers: _Floats, sizes: tuple[int, int], offsets: _Floats, speed: float) -> NetRows: ...
    def __reduce__(self) -> tuple[type[NetRows], tuple[_Floats, list[int], _Floats, float]]: ...

@final
class NetParts:
    """Links that are solved together, each after those at which they hang."""

@final
class NetFollowed:
    """A circuit as its net followed it, which makes rows of it at any inputs."""

@final
class Net:
    """A tree of one-freedom steps closed by rows."""

    def __new__(
        cls,
        letters: str,
        advances: _Floats,
        parents: Sequence[int | None],
        origins: _Floats,
        axes: _Floats,
        reads: _Floats,
        rows: Sequence[
            tuple[
                str,
                tuple[int | None, int | None],
                tuple[tuple[float, float, float], tuple[float, float, float]],
                float,
            ]
        ],
        facing: Sequence[tuple[tuple[int | None, int | None], tuple[float, float, float]]],
        size: float,
        joints: Sequence[tuple[str, float, tuple[int | None, int | None], Sequence[int]]],
        before: _Floats,
        after: _Floats,
    ) -> Net: ...
    def freedoms(
        self,
    ) -> tuple[int, list[list[float]], list[list[float]]]: ...
    def parts(self, solved: Sequence[_RawDyad | _RawBlock | _RawBody | _RawLoop]) -> NetParts: ...
    def modes(
        self, parts: NetParts, driven: int, value: float
    ) -> tuple[
        _Floats, _Floats, npt.NDArray[np.bool_], Literal["closed-form", "algebraic", "monodromy", "searched"]
    ]: ...
    def searched_modes(
        self, column: int, value: float
    ) -> tuple[_Floats, _Floats, npt.NDArray[np.bool_], npt.NDArray[np.bool_]]: ...
    def motion(
        self,
        parts: NetParts | None,
        input: int,
        output: int,
        samples: int,
        speed: float,
        law: _Floats | None = None,
    ) -> tuple[RawMotion, list[NetRows]]: ...
    def circuit_through(
        self,
        parts: NetParts | None,
        pose: _Floats,
        input: int,
        output: int,
        samples: int,
        speed: float,
        law: _Floats | None = None,
    ) -> tuple[tuple[RawCircuit, NetRows], NetFollowed] | float | list[int] | None: ...
    def circuit_again(
        self,
        followed: NetFollowed,
        input: int,
        output: int,
        samples: int,
        speed: float,
        law: _Floats | None = None,
    ) -> tuple[RawCircuit, NetRows] | None: ...
    def ratio_at_rest(self, pose: _Floats, input: int, output: int) -> float | None: ...
    def point(self, rows: NetRows, link: int | None, at: _Floats) -> _Floats: ...

def biconnected_parts(links: int, between: Sequence[tuple[int, int]], root: int) -> list[list[int]]: ...
def net_blocks(
    between: Sequence[tuple[int, int]], rows: Sequence[int], known: Sequence[bool], freedoms: int
) -> tuple[Literal["blocks", "free", "held"], list[tuple[list[int], list[int]]]]: ...

_Three = tuple[int, int, int]

@final
class Product:
    """A rigid motion that depends on numbers of a description, in radians and lengths."""

    def __new__(cls) -> Product: ...
    @staticmethod
    def still(matrix: _Floats) -> Product: ...
    @staticmethod
    def turn(axis: int, number: int) -> Product: ...
    @staticmethod
    def slide(axis: int, number: int) -> Product: ...
    @staticmethod
    def drawn(
        at: _Three, axes: Sequence[_Three], which: int, towards: _Three, has_plane: bool
    ) -> Product: ...
    @staticmethod
    def held(line: Sequence[_Three], which: int, written: _Three | None, given: _Floats) -> Product: ...
    def __add__(self, value: Product, /) -> Product: ...
    def __radd__(self, value: Product, /) -> Product: ...
    def __eq__(self, value: object, /) -> bool: ...
    @property
    def back(self) -> Product: ...
    @property
    def slides(self) -> list[int]: ...
    def pose(self, values: _Floats) -> _Floats: ...

@final
class Carried:
    """A point of the link behind so many steps (joints of the core); coordinates are numbers, or given."""

    def __new__(
        cls,
        steps: int,
        frame: Product,
        place: _Three | None = None,
        at: tuple[float, float, float] = ...,
    ) -> Carried: ...
    def __eq__(self, value: object, /) -> bool: ...
    @property
    def steps(self) -> int: ...
    @property
    def frame(self) -> Product: ...
    @property
    def place(self) -> _Three | None: ...
    @property
    def at(self) -> tuple[float, float, float]: ...

@final
class LoopWord:
    """The joints of a loop, and what is between them by the numbers of a description."""

    def __new__(
        cls,
        letters: str,
        pitches: Sequence[int | None],
        fixed: Sequence[Product],
        held: Sequence[int],
        spins: int,
        scales: Sequence[float],
        size: float,
    ) -> LoopWord: ...
    def at(self, numbers: _Floats, input: int, only: Sequence[int], points: Sequence[Carried]) -> Numbers: ...

@final
class Numbers:
    """A loop that knows what its numbers move; lengths relative to the size."""

    def twists(self, frame: Product) -> list[tuple[int, list[float]]]: ...
    def slopes(self, values: _Floats, order: int) -> list[_Floats]: ...
    def places(self, values: _Floats) -> _Floats: ...
    def follow(
        self,
        values: _Floats,
        inputs: _Floats,
        numbers: _Floats | None = None,
        steps: _Floats | None = None,
    ) -> tuple[_Floats, _Floats]: ...

_Place = tuple[int, _Floats, Sequence[tuple[int, list[float]]]]

@final
class Acting:
    """What acts on a loop; lengths relative to the size, forces in kg size/s^2."""

    def __new__(
        cls,
        gravity: _Floats,
        bodies: Sequence[tuple[int, float, _Floats, _Floats, Sequence[tuple[int, list[float]]]]],
        loads: Sequence[tuple[_Place, _Floats, _Floats, bool]],
        springs: Sequence[tuple[_Place, _Place, _Floats]],
        joint_springs: Sequence[tuple[int, _Floats]],
    ) -> Acting: ...

def reactions(
    numbers: Numbers,
    acting: Acting,
    values: _Floats,
    speeds: _Floats,
    factors: _Floats,
    joints: Sequence[int],
    frames: _Floats,
    with_numbers: bool,
) -> list[_Floats]: ...

@final
class Rows:
    """Rows of a circuit, of which their loop tells the points of any link; pickled as their numbers."""

    def __new__(
        cls, numbers: _Floats, offsets: _Floats, speed: float, still: tuple[int, float] | None = None
    ) -> Rows: ...
    def __reduce__(
        self,
    ) -> tuple[type[Rows], tuple[_Floats, _Floats, float, tuple[int, float] | None]]: ...

@final
class Course:
    """What makes the rows of a long circuit whenever they are wanted: its loop does."""

    @property
    def statuses(self) -> list[int]: ...
    @property
    def residual(self) -> float | None: ...

@final
class Followed:
    """A circuit as its loop followed it, which makes rows of it at any inputs."""

@final
class RawCircuit:
    """A circuit: joint values with three derivatives (4, n, columns), other rows (n,), and measures."""

    @property
    def joints(self) -> _Floats: ...
    @property
    def status(self) -> _Integers: ...
    @property
    def branch(self) -> _Integers: ...
    @property
    def mode(self) -> _Integers | None: ...
    @property
    def residual(self) -> _Floats: ...
    @property
    def condition(self) -> _Floats: ...
    @property
    def motion_type(self) -> str: ...
    @property
    def closed(self) -> bool: ...
    @property
    def turns(self) -> int: ...
    @property
    def dead_centres(self) -> list[tuple[Literal["input", "output"], float, float, int, float]]: ...
    @property
    def input_range(self) -> tuple[float, float] | None: ...
    @property
    def output_range(self) -> tuple[float, float] | None: ...
    @property
    def transmission(self) -> _Ends | None: ...
    @property
    def angle(self) -> _Ends | None: ...
    @property
    def velocity(self) -> _Ends | None: ...
    @property
    def acceleration(self) -> _Ends | None: ...
    @property
    def jerk(self) -> _Ends | None: ...
    @property
    def swing(self) -> float | None: ...
    @property
    def time_ratio(self) -> float | None: ...
    @property
    def many_strokes(self) -> bool: ...
    @property
    def rows(self) -> Rows | None: ...
    @property
    def course(self) -> Course | None: ...

@final
class RawMotion:
    """A motion: `limits` of an RSSR, `search` of other loops, columns `moving` with the input at rest."""

    @property
    def motion_type(self) -> str: ...
    @property
    def limits(self) -> _Floats | None: ...
    @property
    def circuits(self) -> list[RawCircuit]: ...
    @property
    def change_points(self) -> list[tuple[list[float], list[int], int, int]]: ...
    @property
    def search(self) -> RawSearch | None: ...
    @property
    def moving(self) -> list[int] | None: ...

@final
class RawFound:
    """How freely a loop moves; `wrenches` (k, 6) are borne by redundant constraints."""

    @property
    def rank(self) -> int: ...
    @property
    def finite(self) -> int: ...
    @property
    def wrenches(self) -> _Floats: ...

@final
class RawSearch:
    """What a search of circuits came to."""

    @property
    def found(self) -> RawFound | None: ...
    @property
    def completeness(self) -> Literal["counted", "algebraic", "monodromy", "searched"]: ...
    @property
    def columns(self) -> list[int]: ...
    @property
    def values(self) -> int: ...
    @property
    def unfollowed(self) -> int: ...
    @property
    def bound(self) -> Literal["long-curves", "change-points", "memory"] | None: ...
    @property
    def open_by(self) -> _Floats: ...
    @property
    def count(self) -> RawCount | None: ...
    @property
    def uncounted(self) -> Literal["searched", "lost", "still"] | None: ...

@final
class RawCount:
    """The account of a column's branch points; ranges that are open with what is missing there."""

    @property
    def column(self) -> int: ...
    @property
    def dead_centres(self) -> int: ...
    @property
    def complex_branch_points(self) -> int: ...
    @property
    def poles(self) -> int: ...
    @property
    def circles(self) -> int: ...
    @property
    def open(self) -> list[tuple[float, float, int | None]]: ...

@final
class RawMeasures:
    """Measures of circuits (c,); extremes (c, 4). NaN where there are none."""

    @property
    def turns(self) -> _Integers: ...
    @property
    def swing(self) -> _Floats: ...
    @property
    def time_ratio(self) -> _Floats: ...
    @property
    def transmission(self) -> _Floats: ...
    @property
    def velocity(self) -> _Floats: ...
    @property
    def acceleration(self) -> _Floats: ...
    @property
    def jerk(self) -> _Floats: ...

@final
class RssrBatch:
    """Motions of n RSSRs: codes, limits (n, 4), how many circuits; and these one after the other."""

    @property
    def codes(self) -> npt.NDArray[np.uint8]: ...
    @property
    def limits(self) -> _Floats: ...
    @property
    def circuits(self) -> _Integers: ...
    @property
    def measures(self) -> RawMeasures: ...

@final
class LoopBatch:
    """Motions of n loops: whether driven, type, how many circuits; and these one after the other."""

    @property
    def status(self) -> npt.NDArray[np.uint8]: ...
    @property
    def motion_types(self) -> list[str]: ...
    @property
    def circuits(self) -> _Integers: ...
    @property
    def circuit_types(self) -> list[str]: ...
    @property
    def limit_counts(self) -> _Integers: ...
    @property
    def limits(self) -> _Floats: ...
    @property
    def measures(self) -> RawMeasures: ...

def classify_rssr(dimensions: _Floats, input: str, threads: int) -> tuple[npt.NDArray[np.uint8], _Floats]: ...
def measure_loops(
    letters: str,
    advances: _Floats,
    base: _Floats,
    ground: _Floats,
    links: _Floats,
    input: int,
    output: int,
    samples: int,
    speed: _Floats,
    threads: int,
    drawn: _Floats | None = None,
) -> LoopBatch: ...
def measure_rssr(dimensions: _Floats, input: str, speed: _Floats, threads: int) -> RssrBatch: ...
def simd_level() -> str: ...
def piecewise(edges: _Floats, series: _Floats, places: _Floats, on: _Integers | None = None) -> _Floats: ...
def driven(
    edges: _Floats,
    quantities: _Floats,
    lap: float | None,
    begin: tuple[float, float, float, float],
    errors: tuple[float, float],
    bounds: tuple[float, float],
    motor: tuple[bool, _Floats, _Floats] | Callable[[float, float], float] | None = None,
) -> tuple[_Floats, _Floats, tuple[float, float], bool, bool]: ...

#: Indices (n,), places (n,), and measures (n, 8): figure, error, transmission angle, both ball angles, start,
#: branch, sense.
_Entries = tuple[_Integers, _Integers, _Floats]

@final
class RawTally:
    """The tally of the linkages of some indices."""

    @property
    def verdicts(self) -> list[int]: ...
    @property
    def types(self) -> list[int]: ...
    @property
    def limits(self) -> list[int]: ...
    @property
    def spreads(self) -> dict[str, tuple[float, list[int]]]: ...
    @property
    def best(self) -> _Entries: ...
    @property
    def nearest(self) -> _Entries: ...

@final
class Survey:
    """RSSRs drawn from a sequence, and what is wanted of them."""

    def __new__(
        cls,
        bounds: _Floats,
        seed: int,
        *,
        tolerance: float,
        motion_type: int | None,
        ratio: float,
        transmission: float,
        cones: Sequence[float],
        seats: Sequence[Sequence[float] | None],
        rank: str,
        readings: _Floats | None = None,
        swing: Sequence[float] | None = None,
        ends_only: bool = False,
        monotone: bool = False,
    ) -> Survey: ...
    def tally(self, first: int, count: int) -> RawTally: ...
    def numbers(self, indices: _Integers) -> _Floats: ...

def survey_figures(
    numbers: _Floats,
) -> tuple[npt.NDArray[np.uint8], _Floats, _Floats, _Floats, _Floats]: ...
