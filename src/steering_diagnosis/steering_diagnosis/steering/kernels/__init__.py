"""Compiled kernels of the replay; steering_core.compiled watches this folder for changes."""
