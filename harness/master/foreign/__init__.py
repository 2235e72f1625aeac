"""FMUs of any origin: read with suspicion, described by what they can, run by fmpy."""
