"""Every command with its arguments and options, from the program's own command line."""

from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_args, get_type_hints

import typer

from page_tables import code, table
from sevenbar.commands.cli import app
from sevenbar.commands.command import EXAMPLES

#: The page that shows how to use each command.
PAGES = {
    "analyze": "analyze.md",
    "modes": "analyze.md#modes",
    "plot": "analyze.md#figures",
    "gallery": "gallery.md",
    "studio": "studio.md",
    "compare": "measured.md",
    "calibrate": "measured.md",
    "axodes": "theory_measures.md",
    "free": "theory_free.md",
    "forces": "forces.md",
    "simulate": "simulation.md",
    "export": "export.md",
    "axes": "tables.md#axes-picked-from-a-cad-model",
    "sweep": "sweep.md",
    "map": "maps.md",
    "tolerance": "tolerance.md",
    "design function": "synthesis.md",
    "design swing": "synthesis.md",
    "design task": "design-task.md",
    "design survey": "synthesis.md",
    "design exact": "synthesis.md",
    "design path": "path.md",
    "design point": "points.md",
    "design inertia": "points.md",
}


#: What an option's value is, by its type.
KINDS = {int: "COUNT", float: "NUMBER", str: "TEXT", Path: "PATH"}


def commands() -> dict[str, Any]:
    """Every command by its words, in the order of `sevenbar --help`."""
    return dict(_below(typer.main.get_command(app), ""))


def _below(group: Any, words: str) -> Iterator[tuple[str, Any]]:
    context = typer.Context(group)
    for name in group.list_commands(context):
        command = group.get_command(context, name)
        if hasattr(command, "list_commands"):
            yield from _below(command, f"{words}{name} ")
        else:
            yield f"{words}{name}", command


def all_commands(pages: Path, _: str) -> str:
    """A section for each command."""
    return "\n".join(_section(words, command, pages) for words, command in commands().items())


def _title(page: Path) -> str:
    """The title of a page."""
    return page.read_text(encoding="utf-8").partition("\n")[0].removeprefix("# ")


def _section(words: str, command: Any, pages: Path) -> str:
    # those of the shared options are texts
    kinds = defaultdict(lambda: str, get_type_hints(command.callback))
    arguments = [param for param in command.params if param.param_type_name == "argument"]
    shown = [param for param in command.params if not param.hidden]
    usage = " ".join([*(_metavar(param) for param in arguments), "[OPTIONS]"])
    return (
        f"## sevenbar {words}\n\n{command.help}\n\n"
        f"    sevenbar {words} {usage}\n\n"
        f"{_examples(words)}"
        f"How to use it: [{_title(pages / PAGES[words].partition('#')[0])}]({PAGES[words]}).\n\n"
        f"{table(('', 'value', 'meaning'), [_row(param, kinds[param.name]) for param in shown])}"
    )


def _examples(words: str) -> str:
    return "For example\n\n" + "".join(f"    {call}\n" for call in EXAMPLES[words.split()[-1]]) + "\n"


def _metavar(argument: Any) -> str:
    name = argument.metavar or argument.name.upper()
    return name if argument.required or name.startswith("[") else f"[{name}]"


def _row(param: Any, kind: Any) -> tuple[str, str, str]:
    words = param.help or ""
    if param.param_type_name == "argument":
        return code(_metavar(param)), "", words
    if param.required:
        words += " Required."
    elif not param.is_flag and param.default is not None:
        words += f" Left out: {code(str(param.default))}."
    names = ", ".join(code(name) for name in (*param.opts, *param.secondary_opts))
    return names, "" if param.is_flag else code(param.metavar or _kind(kind)), words


def _kind(kind: Any) -> str:
    """What a value is, from the type of the command's argument: `list[str] | None` is a text."""
    inner = [part for part in get_args(kind) if part is not type(None)]
    if inner:
        return _kind(inner[0])
    return KINDS[kind]
