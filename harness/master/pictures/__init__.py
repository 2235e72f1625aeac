"""Pictures of a run, from what it recorded and its scene."""
