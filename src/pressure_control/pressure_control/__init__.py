"""Boost-curve reference and the controllers of the two pressure control valves."""
