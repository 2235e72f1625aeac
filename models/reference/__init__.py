"""Independent motion of a whole assembly, to hold co-simulation against."""
