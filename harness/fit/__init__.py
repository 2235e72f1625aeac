"""Values of a scene found from what was measured, with how well they are known."""
