"""The atlas of a designer: a measure, or the motion type with exact boundaries, over two dimensions."""
