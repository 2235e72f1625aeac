"""Stability of the balanced motion, proved for whole intervals of speeds and parameters.

Parameters are balls (python-flint) around their exact decimal values.

`slopes`: balls with derivatives by what differs in a set of machines.  `arrays`: arrays of balls.
`lines`: bearings over the speed, between two rows of their tables.  `rotor_tables`: the rotor of a
scene's table.  `rotors`: balls of its matrices.  `balanced`: where the weights balance, and what
the rotor sees of them.  `equations`: x' = A(w, beta) x from both.  `series`: sums and products of
matrices in floating point with a bound of their error.  `modes`: approximate coordinates in which A
is nearly diagonal, for a range of speeds and parameters.  `certificate`: what these coordinates
prove.  `window`: Dubovik's limits in closed form.
"""
