"""What a task file may hold, checked with pydantic: the one model of it, and of the page of its keys.

The keys of each kind of want and must are in its own module. Angles are in degrees where no unit is given,
lengths in the linkage's own unit.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import partial, reduce
from operator import or_
from typing import TYPE_CHECKING, Annotated, Any, TypeVar, get_args

from pydantic import BeforeValidator, Field, ValidationError

from sevenbar.description.mistakes import FileForms
from sevenbar.description.values import Angle, TableForm, Text, key, one_of
from sevenbar.design.limits import MOTION_TYPES
from sevenbar.design.task import musts, wants
from sevenbar.design.task.task import MustForm, WantForm
from sevenbar.design.task.values import Span, Words
from sevenbar.errors import DescriptionError

GOALS = ("least squares", "minimax")
PLACEMENTS = ("fixed", "free", "free with scale")

F = TypeVar("F", bound=TableForm)


def _flat(value: object) -> object:
    """Tables in tables as one: TOML reads a name with a dot and no quotes, as in P.x, as a table."""
    if not isinstance(value, dict):
        return value
    result: dict[str, object] = {}
    for name, own in value.items():
        inner = _flat(own)
        result |= (
            {f"{name}.{key}": one for key, one in inner.items()} if isinstance(inner, dict) else {name: own}
        )
    return result


class LimitsForm(TableForm):
    """What the linkage is as a whole."""

    motion_type: Annotated[
        str | None,
        *one_of("motion type", MOTION_TYPES),
        key("seen from its input; left out, any"),
    ] = None
    size: Annotated[Span | None, key("shortest link and longest dimension", "length")] = None
    transmission: Annotated[
        Angle,
        key("the least transmission angle where it is used; of measures alone, over the whole circuit"),
    ] = 0.0


def _by_kind(forms: Iterable[type[F]]) -> dict[str, type[F]]:
    return {get_args(form.model_fields["kind"].annotation)[0]: form for form in forms}


#: The forms of the tables by their kinds.
WANTS = _by_kind(one.form for one in wants.WANTS)
MUSTS = _by_kind(one.form for one in musts.MUSTS)


def _with_kind(value: object, synonyms: Mapping[str, str]) -> object:
    """A table whose kind may be another word for it."""
    if not isinstance(value, dict) or not isinstance(kind := value.get("kind"), str):
        return value
    return {**value, "kind": synonyms.get(kind, kind)}


def _tables(forms: Mapping[str, type[WantForm | MustForm]]) -> Any:
    """The type of a table that is one of some forms, by its kind."""
    synonyms = {word: kind for kind, form in forms.items() for word in form.synonyms}
    named = BeforeValidator(partial(_with_kind, synonyms=synonyms))
    return Annotated[reduce(or_, forms.values()), Field(discriminator="kind"), named]


if TYPE_CHECKING:
    _Want = WantForm
    _Must = MustForm
else:
    _Want, _Must = _tables(WANTS), _tables(MUSTS)


class TaskForm(TableForm):
    """A whole task file."""

    linkage: Annotated[
        str | dict[str, Any],
        key("a file below the folder of this one, a name of the gallery, or tables of a linkage file"),
    ]
    want: Annotated[tuple[_Want, ...], key("what is wanted; one or more")]
    free: Annotated[
        dict[str, Span],
        BeforeValidator(_flat),
        key("numbers that may change and their bounds, by name or pattern", "as in the linkage's file"),
    ]
    must: Annotated[tuple[_Must, ...], key("what must hold")] = ()
    limits: Annotated[LimitsForm, key("motion type, size, transmission")] = LimitsForm()
    goal: Annotated[
        str,
        *one_of("goal", GOALS),
        key("what is made small: the squares of all residuals, or the greatest of them"),
    ] = "least squares"
    placement: Annotated[
        str,
        *one_of("placement", PLACEMENTS),
        key("whether the linkage may stand anywhere, perhaps in any size; paths and poses see it"),
    ] = "fixed"
    follow: Annotated[
        Words | None, key("dimensions that the file leaves out (L2) and that follow from the others")
    ] = None
    name: Annotated[Text | None, key("of the task, for reports; left out, the linkage's")] = None


TASK_FORMS = FileForms(
    TaskForm,
    {"limits": LimitsForm},
    once=("limits",),
    kinds={"want": WANTS, "must": MUSTS},
)


def check_form(raw: Mapping[str, Any], length_unit: str, source: str) -> TaskForm:
    """The checked form of a file's tables, or `DescriptionError` with every problem in it."""
    try:
        return TaskForm.model_validate(raw, context={"length_unit": length_unit, "angle_unit": "deg"})
    except ValidationError as error:
        problems = [TASK_FORMS.problem(detail) for detail in error.errors(include_url=False)]
        raise DescriptionError(list(dict.fromkeys(problems)), source) from None
