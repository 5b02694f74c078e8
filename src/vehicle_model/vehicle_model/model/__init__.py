"""The vehicle's kernels; they import each other relatively (see steering_core.specialise)."""
