"""The ring part filled with liquid as a unit: declared in `variables`, computed in `slave`."""
