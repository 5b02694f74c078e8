"""An emulated rig: its own copy of the plant behind a link. The only part with physics in it."""
