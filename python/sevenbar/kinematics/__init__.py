"""The loop and what is asked of it: assembly modes, circuits, rates, mobility, measures."""
