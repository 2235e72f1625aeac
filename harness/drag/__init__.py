"""Drag of a ball on its track, from a measured decay or from the oil."""
