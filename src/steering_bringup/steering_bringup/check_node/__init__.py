"""``steer check-node``: an overlay node alone with a simulated car, an arbiter, and faults."""
