"""Balls, rollers or pendulums as a unit: declared in `variables`, computed in `slave`."""
