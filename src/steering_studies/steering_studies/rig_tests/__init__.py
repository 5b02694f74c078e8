"""The source's rig tests (section 3.2) as scenarios: on the simulated plant, or as recorded."""
