"""A loop whose constraint is met twice over."""

Z = [0, 0, 1]


def named(kinds_and_places):
    return [
        {"name": name, "kind": kind, "at": list(at), **({"axis": list(axis)} if axis else {})}
        for name, (kind, at, axis) in zip("abcdefg", kinds_and_places, strict=False)
    ]


#: The ball must be square above the cylinder's axis, at the distance of their planes: one condition for two
#: angles, which is met twice over wherever it is met.
C = ("C", (1, -1, -1), Z)


DOUBLE = named([("R", (-2, 2, 1), (0, 1, 0)), ("S", (1, 2, 1), None), C, ("R", (-1, -2, -2), (0, 1, 0))])
