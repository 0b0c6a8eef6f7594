"""Forces along a circuit, bodies and loads, free motion."""
