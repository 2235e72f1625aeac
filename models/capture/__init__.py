"""Weights that are left behind at a natural frequency of the rotor: closed form, without a run."""

from .capture import Capture, LeftBehind, NaturalFrequency, capture

__all__ = ["Capture", "LeftBehind", "NaturalFrequency", "capture"]
