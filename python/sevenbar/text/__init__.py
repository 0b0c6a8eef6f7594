"""What people write: numbers with units, ranges, tables of text."""
