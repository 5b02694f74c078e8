"""Manoeuvres and the driver who follows them; the driver node."""
