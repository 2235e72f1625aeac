"""A scene's FMUs, coupled and stepped."""
