"""A linkage as a file describes it: what it may hold, its errors, its way to a linkage and back."""
