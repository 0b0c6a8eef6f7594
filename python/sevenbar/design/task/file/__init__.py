"""A design task as a file: its keys, its values, what is wrong with it."""
