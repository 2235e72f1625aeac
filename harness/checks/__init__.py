"""Checks of a scene against theory, a measurement or a closed form."""
