"""Weights that are left behind: integrations that share no code with the package."""
