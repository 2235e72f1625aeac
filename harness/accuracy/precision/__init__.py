"""Error against run time: coupling schemes beside integration in one piece."""
