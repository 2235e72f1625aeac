"""Files among the resources of a Python FMU that its slave reads."""

from __future__ import annotations

OPTIONS = "options.json"  # build options, and with them the sizes
START = "start.json"  # where there is one: start values in place of the unit's own
