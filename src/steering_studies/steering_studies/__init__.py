"""Rig tests, identification, linear analysis, designs and reproduction of the source."""
