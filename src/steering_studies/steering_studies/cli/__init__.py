"""Commands of ``steer`` that this package brings, one a file."""
