"""Weights that are left behind, by the closed form of `models.capture`: of a scene, no run."""
