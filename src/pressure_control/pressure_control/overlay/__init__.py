"""Torque overlays: what active-safety nodes ask, limited and arbitrated for both controllers."""
