"""What is done with a scene: its methods, one for every command, which calls it.

The work is in the folder of the feature, which is loaded when a method is called.  Numbers are in
SI units; a speed or an amount may be text with a unit, such as "1200 rpm".  `progress` is called
with the finished fraction; `workers` is a number of processes, for which a script needs
`if __name__ == "__main__":`, or an executor.
"""

from .design_methods import DesignMethods
from .file_methods import FileMethods
from .stability_methods import StabilityMethods


class Methods(StabilityMethods, DesignMethods, FileMethods):
    """The methods of a scene; its tables `run` and `rotor` are called as well, see `tables`."""
