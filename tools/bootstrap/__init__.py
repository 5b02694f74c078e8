"""From a fresh clone to a running command: standard library only, used by ./steer."""
