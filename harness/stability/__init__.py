"""Where balancing begins and ends: main motion, multipliers, boundaries, maps."""
