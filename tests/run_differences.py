"""The greatest differences between two runs of a linkage, of its turns and of its slides."""


def turns(run):
    """The greatest difference of any joint's turn [rad]."""
    return max(found.greatest for found in run.differences if found.quantity.endswith(" angle"))


def slides(run):
    """The greatest difference of any joint's slide, in sizes; 0 where nothing slides."""
    columns = [f"{name} position" for name in run.linkage.columns]
    return (
        max([found.greatest for found in run.differences if found.quantity in columns], default=0.0)
        / run.course.circuit.size
    )
