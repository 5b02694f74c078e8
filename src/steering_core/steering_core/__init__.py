"""Foundation shared by every core: compiled kernels, parameters, names and source specialisation."""
