"""What tolerances of the dimensions do to the motion: exact sensitivities, worst case, Monte Carlo."""
