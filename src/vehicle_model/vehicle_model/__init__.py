"""The load on the rack: linear bicycle model, dry park and none; the vehicle node."""
