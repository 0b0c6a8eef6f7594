"""Circuits and motions as values: rows, rates, extremes, dead centres, points along them."""
