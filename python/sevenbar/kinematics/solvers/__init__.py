"""How a loop is solved: in closed form, by the general path, many at once; what kind of loop it is."""
