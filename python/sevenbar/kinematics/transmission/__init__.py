"""The transmission angle of a loop, its extremes and slopes; limits where input and output rest."""
