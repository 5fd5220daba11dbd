"""A pinhole camera."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Camera:
    """K (3, 3) in pixels, world_to_camera (4, 4), both float64; width and height in pixels."""

    K: np.ndarray
    world_to_camera: np.ndarray
    width: int
    height: int

    @property
    def R(self) -> np.ndarray:
        """The rotation (3, 3) of world_to_camera: x_camera = R x_world + t."""
        return self.world_to_camera[:3, :3]

    @property
    def t(self) -> np.ndarray:
        """The translation (3,) of world_to_camera."""
        return self.world_to_camera[:3, 3]

    @property
    def center(self) -> np.ndarray:
        """The camera's position (3,) in the world."""
        return -self.R.T @ self.t

    def resized(self, width: int, height: int) -> Camera:
        """The same view on an image of another size."""
        scale = np.diag([width / self.width, height / self.height, 1.0])
        return Camera(scale @ self.K, self.world_to_camera, width, height)
