"""Design tasks with a known answer, and whether the search finds it."""
