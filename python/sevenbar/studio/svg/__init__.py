"""Curves of the studio as SVG."""
