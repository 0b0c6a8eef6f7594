"""Linkages of any kind whose point follows a wanted path."""
