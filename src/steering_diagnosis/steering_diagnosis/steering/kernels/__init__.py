"""Compiled kernels of the replay; part of the key of the kernels' cache (steering_core.compiled)."""
