"""Pictures of linkages, of curves and of films."""
