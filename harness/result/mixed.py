"""What the parts of a result take for granted of it, for the type checker."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ..scene import Scene
    from .verdict import Verdict

    class Mixed:
        """The fields and methods of `Result` that its bases use."""

        time: NDArray[np.float64]
        signals: dict[str, NDArray[np.float64]]
        signal_units: dict[str, str]
        scene_title: str
        scene: Scene | None
        unknown_error: str

        @property
        def error_known(self) -> bool: ...

        def __getitem__(self, name: str) -> NDArray[np.float64]: ...

        def summary(self) -> Verdict: ...

        def sag(self) -> dict[str, NDArray[np.float64]]: ...

        def residual_moment(self, balancer: str) -> NDArray[np.float64]: ...
else:
    Mixed = object
