"""The loop as a value: joints, fixed transforms, stops, drive, and rigid motions."""
