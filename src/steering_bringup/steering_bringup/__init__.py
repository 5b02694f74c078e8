"""Node sets, scenarios, the launcher, recording, comparison and the command line."""
