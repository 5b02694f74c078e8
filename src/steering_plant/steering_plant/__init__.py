"""The hydraulic steering gear: mechanics, valves, chambers, effects and the plant node."""
