"""Links to a rig, one file or two each, behind the interface of ``link.Link``."""
