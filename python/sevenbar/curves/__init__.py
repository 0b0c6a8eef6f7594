"""Functions of the input from their values at rows: what lies between, extremes, means, running integrals."""
