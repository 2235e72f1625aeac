"""Oil films of journal bearings, as tables that a scene reads."""
