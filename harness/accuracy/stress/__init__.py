"""Stiff and extreme cases: each right, or clearly refused."""
