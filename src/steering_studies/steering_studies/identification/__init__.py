"""From rig tests to parameters: one estimator a test, each with intervals."""
