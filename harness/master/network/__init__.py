"""Units of any origin coupled: wiring, order, signals; in the schemes the same as ours."""
