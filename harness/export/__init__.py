"""A scene in files for other tools: FMUs, one-file FMUs, packages, releases, reference results."""
