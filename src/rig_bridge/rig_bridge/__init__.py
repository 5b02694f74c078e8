"""Between the bench and a hardware test rig: channels, limits, watchdogs and links. No physics."""
