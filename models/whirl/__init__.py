"""Balance that is not rest: the steady whirl that weights leave when they cannot undo it all."""
