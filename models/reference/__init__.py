"""Independent motion of a whole assembly, with which co-simulation is compared."""
