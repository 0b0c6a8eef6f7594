"""What acts on a linkage and what follows: bodies, loads and springs; torque, reactions, sizing, balance."""
