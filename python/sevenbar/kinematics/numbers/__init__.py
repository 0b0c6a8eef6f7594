"""The loop by the numbers of its description, with exact derivatives by each."""
