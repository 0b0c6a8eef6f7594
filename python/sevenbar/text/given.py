"""Numbers that a caller in Python gives as texts with their units: `"30 deg"`, `"12 mm"`."""

from __future__ import annotations

from sevenbar.errors import RequestError, shown


def given_number(key: str, value: object, unit: str) -> object:
    """What a caller gives for a number in a unit, "rad" or a length: a text is read, anything else as it is.

    Raises `RequestError` for a text that is no number with a unit that fits.
    """
    if not isinstance(value, str):
        return value
    # `import sevenbar` needs no reader of formulas
    from sevenbar.text.amounts import amount_in, lacks_unit

    number = None if lacks_unit(value, "angle" if unit == "rad" else "length") else amount_in(value, unit)
    if number is None:
        example = "one as in '30 deg'" if unit == "rad" else f"one as in '12 {unit}'"
        plain = "radians" if unit == "rad" else unit
        raise RequestError(
            f"{key}: {shown(value)} is not a number with a unit that fits; give {example}, "
            f"or a number in {plain}"
        )
    return number
