"""The coupled units of a scene as one FMU."""
