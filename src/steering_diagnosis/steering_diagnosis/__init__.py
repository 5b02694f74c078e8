"""Shows what the simulation gets wrong, names the cause and extends the model."""
