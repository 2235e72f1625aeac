"""Names of the methods that find the speeds at which balancing begins or ends."""

DEFAULT_METHODS = ("criterion", "floquet", "cosim")
METHODS = (*DEFAULT_METHODS, "proved")
