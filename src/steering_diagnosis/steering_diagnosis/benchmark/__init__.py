"""The sealed benchmark: hidden effects, the scorer and a baseline, open to any diagnosis."""
