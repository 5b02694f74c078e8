"""Who may move the rig: a key, a meeting of both ends, and tags on every packet. Pure but keys."""
