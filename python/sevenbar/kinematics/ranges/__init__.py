"""How far a circuit takes its joints, balls and links, and what part of it the stops allow."""
