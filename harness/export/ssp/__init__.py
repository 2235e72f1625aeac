"""A scene as a system structure package (SSP 1.0) for other tools."""
