"""Points of moving links: acceleration poles, least acceleration, wanted paths, inertia."""
