"""A 3D Gaussian splat as arrays, and its renders."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Optional, Sequence, Tuple, Union

import numpy as np

from . import _core
from .camera import Camera

PathLike = Union[str, "os.PathLike[str]"]
CameraLike = Union[Camera, Tuple[np.ndarray, np.ndarray, int, int]]


@dataclass(eq=False)
class Splat:
    """The raw parameters of N Gaussians, as files of 3DGS hold them. All float32."""

    means: np.ndarray  #: (N, 3) world units
    log_scales: np.ndarray  #: (N, 3) natural logarithm of the standard deviations
    quats: np.ndarray  #: (N, 4) w, x, y, z; of any length
    opacity_logits: np.ndarray  #: (N,)
    sh: np.ndarray  #: (N, 16, 3) spherical harmonics: coefficient first, then RGB; zeros above sh_degree
    sh_degree: int = 3
    support: Optional[np.ndarray] = None  #: (N,) in [0, 1], how far images support each Gaussian; None = not known
    uncertainty: Optional[np.ndarray] = None  #: (N,) in [0, 1], error to expect of what each shows; None = not known
    comments: Sequence[str] = field(default_factory=tuple)  #: of the file's header
    antialiased: bool = False  #: the file says that it was trained so

    def __len__(self) -> int:
        return len(self.means)

    @property
    def scales(self) -> np.ndarray:
        """(N, 3) standard deviations in world units."""
        return np.exp(self.log_scales)

    @property
    def opacities(self) -> np.ndarray:
        """(N,) in [0, 1]."""
        return 1 / (1 + np.exp(-self.opacity_logits))


def read_splat(path: PathLike) -> Splat:
    """Reads .ply .compressed.ply .spz .sog .splat .glb .spz.glb .usda .usdz of any trainer. Raises InputError naming the file.

    What it leaves out or assumes, as a few Gaussians whose numbers are not finite, is a UserWarning.
    """
    return Splat(**_core.read_splat(os.fspath(path)))


def render(splat: Splat, camera: CameraLike, *, sh_degree: Optional[int] = None, background: Sequence[float] = (0, 0, 0),
           antialiased: Optional[bool] = None) -> np.ndarray:  # fmt: skip
    """The image (H, W, 3) that `camera` sees: a Camera, or (K, world_to_camera, width, height).

    Composited on `background` (RGB in [0, 1]) and not clamped. `antialiased` as the splat was trained; None: as
    its file says. Renders on the CPU, on all threads, to the same bits for any number of them. Raises InputError for a
    camera that is none, ValueError for an array of a wrong shape.
    """
    if isinstance(camera, Camera):
        camera = (camera.K, camera.world_to_camera, camera.width, camera.height)
    k, world_to_camera, width, height = camera
    degree = splat.sh_degree if sh_degree is None else sh_degree
    if antialiased is None:
        antialiased = splat.antialiased
    return _core.render(splat.means, splat.log_scales, splat.quats, splat.opacity_logits, splat.sh, k, world_to_camera, int(width),
                        int(height), degree, tuple(background), antialiased)  # fmt: skip
