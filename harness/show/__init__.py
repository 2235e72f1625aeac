"""A scene as a web page that runs the units."""
