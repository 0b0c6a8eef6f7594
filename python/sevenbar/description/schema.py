"""What a linkage description may hold, checked with pydantic: every mistake at once, each with its place.

This is the only model of the file format; `mistakes` turns its errors into the messages that people read.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import ValidationError
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
from pydantic_core import core_schema

from sevenbar.description.contradictions import FORMS, contradictions, grounds, other_file
from sevenbar.description.links import OWN_KEYS
from sevenbar.description.load_schema import BodyForm, ForcesForm, LoadForm, SpringForm
from sevenbar.description.loop_schema import DriveForm, JointForm, LinkForm, LoopForm, PointForm, RssrForm
from sevenbar.description.mistakes import FileForms, path_of
from sevenbar.description.stop_schema import RodForm, StopForm, stop_contradictions
from sevenbar.description.values import TableForm, key
from sevenbar.description.written import joints_of
from sevenbar.errors import DescriptionError, Problem


class LinkageForm(LoopForm):
    """A whole file of format 1."""

    forces: Annotated[ForcesForm, key("gravity, and the unit of masses")] = ForcesForm.model_construct()
    body: Annotated[tuple[BodyForm, ...], key("masses on links")] = ()
    load: Annotated[tuple[LoadForm, ...], key("forces and torques on links")] = ()
    spring: Annotated[tuple[SpringForm, ...], key("springs and dampers")] = ()
    stop: Annotated[tuple[StopForm, ...], key("how far joints may go")] = ()
    rod: Annotated[tuple[RodForm, ...], key("how thick links are")] = ()


class TomlSchema(GenerateJsonSchema):
    """JSON schema of a TOML file, in which a key that is not given is left out: there is no null."""

    def nullable_schema(self, schema: core_schema.NullableSchema) -> JsonSchemaValue:
        """The schema of a key that may be left out: that of its values."""
        return self.generate_inner(schema["schema"])

    def default_schema(self, schema: core_schema.WithDefaultSchema) -> JsonSchemaValue:
        """The schema of a key with a default, which it states where that is a plain value."""
        inner = self.generate_inner(schema["schema"])
        plain = isinstance(schema.get("default"), (str, int, float))
        return {**inner, "default": schema["default"]} if plain else inner


def json_schema() -> dict[str, Any]:
    """The JSON schema (draft 2020-12) of a file of format 1, for editors that complete and check TOML.

    It has keys, kinds of values and allowed words. What belongs together is checked by `load` alone.

        >>> json_schema()["properties"]["length_unit"]["enum"]
        ['um', 'mm', 'cm', 'm', 'in', 'ft']
    """
    from sevenbar.description.net_schema import NetForm

    schema = LinkageForm.model_json_schema(schema_generator=TomlSchema)
    net = NetForm.model_json_schema(schema_generator=TomlSchema)
    # links by name: of one loop, which may have all that a loop has, or of a net
    forms, of_net = schema["$defs"], net["$defs"]
    forms["JointForm"]["properties"]["between"] = of_net["NetJointForm"]["properties"]["between"]
    link = forms["PointForm"]["properties"]["link"]
    link["type"] = [link["type"], of_net["NetPointForm"]["properties"]["link"]["type"]]
    link["description"] += ", or by name"
    forms |= {name: of_net[name] for name in ("PinForm", "NetRodForm")}
    rods = schema["properties"]["rod"]["items"]
    schema["properties"]["rod"]["items"] = {"anyOf": [rods, {"$ref": "#/$defs/NetRodForm"}]}
    schema["properties"] |= {word: net["properties"][word] for word in OWN_KEYS}
    pins_or_joints = {"anyOf": [{"required": ["joint"]}, {"required": ["pin"]}]}
    one_form = [pins_or_joints if form == "joint" else {"required": [form]} for form in FORMS]
    return {"$schema": GenerateJsonSchema.schema_dialect, **schema, "oneOf": one_form}


def check(raw: Mapping[str, Any], context: Mapping[str, Any], *, source: str = "") -> LinkageForm:
    """The checked form of a file's tables.

    `context` is what numbers need to know of the rest (`formulas.context_of`); `source` is the name of the
    file in messages. Raises `DescriptionError` with every problem of the file.
    """
    if other := other_file(raw):
        raise DescriptionError.of_all(source, other)
    ground_places = grounds(raw)
    problems: list[Problem] = []
    try:
        form = LinkageForm.model_validate(raw, context=context)
    except ValidationError as error:
        for detail in error.errors(include_url=False):
            place = detail["loc"]
            if place in ground_places:
                problems.append(Problem(path_of(place), ground_places[place]))
            # an entry that is nothing but a ground has one problem, whatever keys it lacks
            elif place[:2] not in ground_places:
                problems.append(_FORMS.problem(detail))
    joints = joints_of(raw)
    problems += contradictions(raw)
    if not raw.keys().isdisjoint(("body", "load", "spring")):
        # most files have none of these
        from sevenbar.description.loads import load_contradictions

        problems += load_contradictions(raw, joints, context)
    problems += stop_contradictions(raw, joints, context)
    if problems:
        raise DescriptionError(problems, source)
    return form


#: The form of each table, by its head without brackets.
TABLES: dict[str, type[TableForm]] = {
    "rssr": RssrForm,
    "joint": JointForm,
    "link": LinkForm,
    "point": PointForm,
    "drive": DriveForm,
    "forces": ForcesForm,
    "body": BodyForm,
    "load": LoadForm,
    "spring": SpringForm,
    "stop": StopForm,
    "rod": RodForm,
}

_FORMS = FileForms(LinkageForm, TABLES, once=("rssr", "drive", "forces"))
