"""Free motion of one freedom: time as an integral along the circuit, equilibria, and what losses and motors do."""
