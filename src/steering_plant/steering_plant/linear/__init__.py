"""Linear models of the plant at an operating point, and a numerical linearisation."""
