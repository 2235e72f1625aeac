"""The rotor on its supports as a unit: declared in `variables`, computed in `slave`."""
