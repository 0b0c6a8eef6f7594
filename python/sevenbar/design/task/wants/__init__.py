"""Wants as residuals, a module for each family."""
