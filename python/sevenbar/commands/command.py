"""What every command has: `-o` for `--out`, and an option that is given once only; and whole numbers."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from typing import Any

import typer.core

from sevenbar.errors import RequestError, SevenbarError, shown

#: What to say of options of which a second one is a mistake in thought, too.
WHY_ONE = {
    "--input": "one joint drives, so give one of them (loops with two inputs are not covered)",
    "--output": "one joint is the output, so give one of them",
}


class Command(typer.core.TyperCommand):
    """A command of sevenbar."""

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        for parameter in self.params:
            if "--out" in parameter.opts and "-o" not in parameter.opts:
                parameter.opts.append("-o")

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """As usual; an option given twice is refused, of which otherwise the last would count silently."""
        # the parser takes words off the list
        _, _, order = self.make_parser(ctx).parse_args(args=list(args))
        for parameter, count in Counter(order).items():
            single = parameter.param_type_name == "option" and not parameter.multiple
            if count > 1 and single and not getattr(parameter, "is_flag", False):
                option = parameter.opts[0]
                raise RequestError(f"{option}: given {count} times; {WHY_ONE.get(option, 'give it once')}")
        return super().parse_args(ctx, args)


def count_of(option: str) -> Callable[[object], int]:
    """What reads the number of an option, whole and perhaps with an exponent: 360, 1e6.

    >>> count_of("--samples")("1e6")
    1000000
    """

    def read(given: object) -> int:
        text = str(given).strip()
        try:
            return int(text)
        except ValueError:
            pass
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not value.is_integer():
            # no RequestError: the reader of options would take a ValueError for its own
            raise SevenbarError(
                f"{option}: {shown(text)} is not a count; give a whole number, as in 360 or 1e6"
            )
        return int(value)

    return read
