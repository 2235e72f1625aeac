"""Model descriptions of FMI 2.0 and 3.0, documentation and archive of an FMU."""
