"""Machines as they leave the factory: a scene whose values scatter within their tolerances."""
