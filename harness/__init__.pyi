from autobalancer.scene import Scene as Scene
from autobalancer.scene import load as load_scene

from ..fmus.build import build as build
from .checks.runner import check as check
from .errors import SceneError as SceneError
from .errors import SimulationError as SimulationError
from .errors import UnitError as UnitError
from .errors import UserError as UserError
from .result.many import cosimulate_many as cosimulate_many
from .result.result import Result as Result
from .result.run import cosimulate as cosimulate
from .scene import bundled_scenes as bundled_scenes
from .stability.boundaries import speeds as speeds
