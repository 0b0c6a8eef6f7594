"""RSSR linkages for a wanted function or swing."""
