"""Steady motions of a machine with balancers, and how often each is reached."""
