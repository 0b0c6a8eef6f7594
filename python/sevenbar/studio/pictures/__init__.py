"""Linkages as simple bodies in the studio's scene."""
