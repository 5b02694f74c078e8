"""The truth generator: the steering gear written a second time, with formulas of its own.

Nothing of steering_plant is imported here (tests/layering): what it shares with the diagnosis are
the data sheet, the controllers and the driver, whose outputs a record holds anyway.
"""
