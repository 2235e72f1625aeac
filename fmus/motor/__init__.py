"""The motor of limited power as a unit: declared in `variables`, computed in C."""
