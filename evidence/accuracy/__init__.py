"""How exact Sevenbar is: the gallery against references that share no formula with the core."""
