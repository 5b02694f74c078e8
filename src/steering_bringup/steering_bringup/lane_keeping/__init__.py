"""Lane keeping: an example of an active-safety node that plugs into the bench."""
