"""Random scenes against an independent integration: how often a run is right, and says so."""
