"""The one import that differs inside an FMU, where the builder points it at the embedded copy."""

from pythonfmu.enums import Fmi2Status
from pythonfmu.fmi2slave import Fmi2Slave

__all__ = ["Fmi2Slave", "Fmi2Status"]
