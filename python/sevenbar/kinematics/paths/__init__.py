"""A circuit by its own arc length."""
