"""The steering gear as a model that the engine can diagnose."""
