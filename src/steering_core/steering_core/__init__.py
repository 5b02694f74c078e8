"""What every core stands on: compiled kernels, parameters, names, specialised sources."""
