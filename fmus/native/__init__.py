"""The units in C99: their sources, the build of their libraries, and native FMUs."""
