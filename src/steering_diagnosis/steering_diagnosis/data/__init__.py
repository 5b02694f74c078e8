"""Measured data: from bags and files of other tools to one record on the bench's grid and signs."""
