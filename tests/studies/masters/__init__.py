"""Coupling problems with exact solutions, run by our master and by others."""
