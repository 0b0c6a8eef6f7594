"""What acts on a linkage, and what follows from it: masses, loads and springs as values; torque, reactions and balance as arrays."""
