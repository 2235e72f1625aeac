"""Rotor and balancers as FMI 2.0 co-simulation units, and the builder of their FMUs."""
