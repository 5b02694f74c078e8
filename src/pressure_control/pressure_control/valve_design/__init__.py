"""Valve design by optimisation: step time against solenoid force (source, section 6.1)."""
