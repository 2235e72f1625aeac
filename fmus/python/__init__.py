"""The Python units: slaves under pythonfmu, and what an FMU needs to run them."""
