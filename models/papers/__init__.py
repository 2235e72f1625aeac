"""Closed forms and tables of the papers."""
