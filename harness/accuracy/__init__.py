"""How far a run is from right: against its run time, in extreme cases, over random scenes."""
