"""The workspace of a run as arrays."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Dict, List, Optional, Tuple, Union

import numpy as np

from . import _core
from .camera import Camera
from .splat import Splat, read_splat

PathLike = Union[str, "os.PathLike[str]"]


@dataclass(frozen=True, eq=False)
class DepthMap:
    """Depth of a training view, as far as it is known."""

    inverse_depth: np.ndarray  #: (H, W) 1 / z in 1 / world units; 0 = unknown
    confidence: np.ndarray  #: (H, W) in [0, 1]; depth is used from 0.5 on
    normals: np.ndarray  #: (H, W, 3) unit, in the camera's frame; zeros where unknown


@dataclass(frozen=True, eq=False)
class View:
    """A view of the run at working size: undistorted, its images read when they are asked for."""

    name: str
    role: str  #: "train" or "test"
    camera: Camera
    path: Path  #: the photo
    _index: int
    _views: Any
    _depth: Path

    @property
    def image(self) -> np.ndarray:
        """(H, W, 3) in [0, 1]."""
        return self._views.load(self._index)[0]

    @property
    def mask(self) -> Optional[np.ndarray]:
        """(H, W) of bool, True = used; None = all pixels are."""
        return self._views.load(self._index)[1]

    @property
    def depth(self) -> DepthMap:
        """Raises InputError where the run has none, as for test views."""
        return DepthMap(*self._views.depth(self._index, os.fspath(self._depth)))


@dataclass(frozen=True, eq=False)
class Proposal:
    """A proposed view that was validated."""

    name: str
    camera: Camera
    _root: Path

    @property
    def image(self) -> np.ndarray:
        """(H, W, 3) in [0, 1], as training uses it."""
        return _core.read_image(os.fspath(self._root / "proposals" / f"{self.name}.png"))

    @property
    def confidence(self) -> np.ndarray:
        """(H, W) in [0, 1], 1 = full trust."""
        return _core.read_image(os.fspath(self._root / "confidence" / f"{self.name}.png"))[..., 0]


class Workspace:
    """Reads the workspace of a run; what it holds is read when it is first asked for. Its results are not changed.

    Raises InputError when the folder is no workspace or a file of it is missing or damaged. `views` also needs the photos
    of the run, and that no run is going on in the workspace.
    """

    def __init__(self, path: PathLike):
        self.path = Path(path)
        if not (self.path / "options.json").is_file():
            raise _core.InputError(f"{self.path}: holds no run of oraclegs; name a workspace")

    def __repr__(self) -> str:
        return f"oraclegs.Workspace({str(self.path)!r})"

    def _json(self, name: str) -> Any:
        path = self.path / name
        try:
            return json.loads(path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            raise _core.InputError(f"{path}: is not there; the run has not come so far") from None
        except (OSError, ValueError) as error:
            raise _core.InputError(f"{path}: cannot be read: {error}") from None

    @cached_property
    def options(self) -> Dict[str, Any]:
        """The options of the run, by their names on the command line."""
        return self._json("options.json")["options"]

    @property
    def metrics(self) -> Dict[str, Any]:
        """Scores, times, memory (metrics.json)."""
        return self._json("metrics.json")

    @property
    def stages(self) -> Dict[str, Any]:
        """The finished stages with their records (stages.json)."""
        return self._json("stages.json")

    @property
    def split(self) -> Dict[str, List[str]]:
        """{"train": [names], "test": [names]}."""
        return self._json("split.json")

    @cached_property
    def views(self) -> List[View]:
        """The training views, then the test views."""
        views = _core.RunViews(os.fspath(self.path))
        return [View(name, role, Camera(*camera), Path(photo), index, views, self.path / "depth")
                for index, name, role, camera, photo in views.views()]  # fmt: skip

    @property
    def train_views(self) -> List[View]:
        return [view for view in self.views if view.role == "train"]

    @property
    def test_views(self) -> List[View]:
        return [view for view in self.views if view.role == "test"]

    @cached_property
    def proposals(self) -> List[Proposal]:
        """The proposals that were validated; none where the run made none."""
        if not (self.path / "confidence" / "transforms.json").is_file():
            return []
        targets = _core.targets(os.fspath(self.path / "confidence"), os.fspath(self.path / "frame.json"))
        found = [Proposal(name, Camera(*camera), self.path) for name, camera in targets]
        return [proposal for proposal in found if (self.path / "proposals" / f"{proposal.name}.png").is_file()]

    @cached_property
    def gaussians(self) -> Splat:
        """The trained splat (point_cloud.ply)."""
        return read_splat(self.path / "point_cloud.ply")

    @property
    def curves(self) -> Dict[str, np.ndarray]:
        """Curves of the training (train.csv): an array for each column, NaN where a row has no value."""
        path = self.path / "train.csv"
        if not path.is_file():
            raise _core.InputError(f"{path}: is not there; the run has not trained")
        table = np.genfromtxt(path, delimiter=",", names=True, ndmin=1)
        return {name: table[name] for name in table.dtype.names}
