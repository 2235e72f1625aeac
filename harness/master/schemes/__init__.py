"""Coupling schemes, one a file: `step(system, time, step)` moves the coupled units one step."""
