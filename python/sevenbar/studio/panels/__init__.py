"""What is dragged, typed and pressed in the studio."""
