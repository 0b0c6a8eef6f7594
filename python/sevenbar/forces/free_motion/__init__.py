"""Free motion of one freedom: time as an integral along the circuit, equilibria, losses and motors."""
