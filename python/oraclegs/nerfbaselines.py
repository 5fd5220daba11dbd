"""OracleGS as a method of NerfBaselines, which trains and scores methods of several authors alike.

    export NERFBASELINES_REGISTER=.../oraclegs/nerfbaselines_spec.py
    nerfbaselines train --method oraclegs --backend python --data external://mipnerf360/garden --set iterations=10000

A run is one iteration of NerfBaselines: proposals, oracle and training of `oraclegs.reconstruct` belong together. All
images of the dataset train. The dataset's points are not used: points are triangulated from the training images.
"""

from __future__ import annotations

import json
import os
import shutil
import struct
import tempfile
import weakref
import zlib
from pathlib import Path
from typing import Any, Dict, Optional, Tuple

import numpy as np
from nerfbaselines import Method

from . import Splat, __version__, read_splat, reconstruct, render

_BACKGROUNDS = {"black": (0.0, 0.0, 0.0), "gray": (0.5, 0.5, 0.5), "white": (1.0, 1.0, 1.0)}
_KEPT = ("point_cloud.ply", "metrics.json", "options.json", "split.json", "train.csv")  # of a workspace, in a checkpoint


def _write_png(path: Path, image: np.ndarray) -> None:
    """(H, W, 3) uint8; without a library that NerfBaselines' environment may lack."""

    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    height, width = image.shape[:2]
    rows = np.concatenate([np.zeros((height, 1), np.uint8), image.reshape(height, width * 3)], axis=1)
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows.tobytes(), 1)) + chunk(b"IEND", b""))


def _background(name: str) -> Tuple[float, float, float]:
    if name not in _BACKGROUNDS:
        raise ValueError(f"background is {name!r}, must be one of {', '.join(_BACKGROUNDS)}")
    return _BACKGROUNDS[name]


def _rgb(image: np.ndarray, background: str) -> np.ndarray:
    """uint8 RGB of uint8 or float images with an alpha channel or without."""
    if image.dtype != np.uint8:
        image = np.rint(np.clip(image, 0, 1) * 255).astype(np.uint8)
    if image.shape[-1] == 3:
        return np.ascontiguousarray(image)
    alpha = image[..., 3:4].astype(np.float32) / 255
    behind = 255 * np.asarray(_background(background), np.float32)
    return np.rint(image[..., :3] * alpha + behind * (1 - alpha)).astype(np.uint8)


def write_scene(dataset: Dict[str, Any], folder: Path, background: str = "black") -> None:
    """Writes a dataset of NerfBaselines, with its images loaded and pinhole cameras, as a transforms.json scene."""
    cameras, frames = dataset["cameras"], []
    masks = dataset.get("sampling_masks")
    for i, pose in enumerate(np.asarray(cameras.poses, np.float64)):
        if int(cameras.camera_models[i]) != 0:
            raise ValueError(f"image {i} has no pinhole camera; undistort the dataset first")
        width, height = (int(n) for n in cameras.image_sizes[i])
        name = f"{i:05d}.png"
        _write_png(folder / "images" / name, _rgb(np.asarray(dataset["images"][i])[:height, :width], background))
        if masks is not None:
            mask = np.asarray(masks[i])[:height, :width].reshape(height, width, 1) > 0
            _write_png(folder / "masks" / name, np.repeat(mask, 3, axis=2).astype(np.uint8) * 255)
        fx, fy, cx, cy = (float(x) for x in cameras.intrinsics[i])
        matrix = np.vstack([pose[:3, :4] * [1, -1, -1, 1], [0, 0, 0, 1]])  # from x right, y down to OpenGL's axes
        frames.append({"file_path": f"images/{name}", "fl_x": fx, "fl_y": fy, "cx": cx, "cy": cy, "w": width, "h": height,
                       "transform_matrix": matrix.tolist()})  # fmt: skip
    (folder / "transforms.json").write_text(json.dumps({"camera_model": "PINHOLE", "frames": frames}))


def _background_of(dataset: Dict[str, Any]) -> str:
    color = dataset["metadata"].get("background_color")
    return "white" if color is not None and np.all(np.asarray(color) == 255) else "black"


class OracleGS(Method):
    """Options of `oraclegs.reconstruct` are `config_overrides`: {"iterations": 10000, "proposers": "warp"}."""

    def __init__(self, *, checkpoint: Optional[str] = None, train_dataset: Optional[Dict[str, Any]] = None,
                 config_overrides: Optional[Dict[str, Any]] = None):  # fmt: skip
        super().__init__()
        self.checkpoint = checkpoint
        self._splat: Optional[Splat] = None
        self._antialiased = False
        self._options: Dict[str, Any] = {}
        self._folder: Optional[Path] = None
        if checkpoint is not None:
            saved = json.loads((Path(checkpoint) / "oraclegs.json").read_text())
            self._options = saved["options"]
            self._load(Path(checkpoint))
        self._options.update({name.replace("-", "_"): value for name, value in (config_overrides or {}).items()})
        if train_dataset is not None:
            self._folder = Path(tempfile.mkdtemp(prefix="oraclegs_nerfbaselines_"))
            weakref.finalize(self, shutil.rmtree, self._folder, ignore_errors=True)
            self._options.setdefault("background", _background_of(train_dataset))
            write_scene(train_dataset, self._folder / "scene", self._options["background"])

    @classmethod
    def get_method_info(cls) -> Dict[str, Any]:
        return {"method_id": "oraclegs", "required_features": frozenset(("color",)),
                "supported_camera_models": frozenset(("pinhole",)), "supported_outputs": ("color",)}  # fmt: skip

    def get_info(self) -> Dict[str, Any]:
        return {**self.get_method_info(), "num_iterations": 1, "loaded_step": None if self.checkpoint is None else 1,
                "loaded_checkpoint": self.checkpoint, "hparams": {"oraclegs": __version__, **self._options}}  # fmt: skip

    def train_iteration(self, step: int) -> Dict[str, float]:
        if self._folder is None:
            raise RuntimeError("there is no training dataset")
        workspace = self._folder / "run"
        options = {"report": False, "test_every": 0, **self._options}
        metrics = reconstruct(self._folder / "scene", workspace, **options)
        self._load(workspace)
        seconds = float((metrics.get("train") or {}).get("seconds") or 0)
        return {"gaussians": float(len(self._trained())), "train_seconds": seconds}

    def _load(self, workspace: Path) -> None:
        self._splat = read_splat(workspace / "point_cloud.ply")
        saved = json.loads((workspace / "options.json").read_text())
        self._antialiased = bool(saved.get("options", saved).get("antialiased", False))
        self._workspace = workspace

    def _trained(self) -> Splat:
        if self._splat is None:
            raise RuntimeError("nothing was trained or loaded")
        return self._splat

    def render(self, camera: Any, *, options: Optional[Dict[str, Any]] = None) -> Dict[str, np.ndarray]:
        del options
        camera = camera.item()
        if int(camera.camera_models) != 0:
            raise ValueError("only pinhole cameras are rendered")
        fx, fy, cx, cy = (float(x) for x in camera.intrinsics)
        k = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])
        world_to_camera = np.linalg.inv(np.vstack([np.asarray(camera.poses, np.float64)[:3, :4], [0, 0, 0, 1]]))
        width, height = (int(n) for n in camera.image_sizes)
        background = _background(self._options.get("background", "black"))
        color = render(self._trained(), (k, world_to_camera, width, height), background=background, antialiased=self._antialiased)
        return {"color": np.clip(color, 0, 1)}

    def save(self, path: str) -> None:
        self._trained()
        Path(path).mkdir(parents=True, exist_ok=True)
        for name in _KEPT:
            if (self._workspace / name).exists() and not os.path.samefile(self._workspace, path):
                shutil.copyfile(self._workspace / name, Path(path) / name)
        (Path(path) / "oraclegs.json").write_text(json.dumps({"version": __version__, "options": self._options}) + "\n")

    def export_gaussian_splats(self, *, options: Optional[Dict[str, Any]] = None) -> Dict[str, Any]:
        del options
        splat = self._trained()
        return {"means": splat.means, "scales": splat.scales, "opacities": splat.opacities[:, None],
                "quaternions": splat.quats / np.linalg.norm(splat.quats, axis=1, keepdims=True),
                "spherical_harmonics": np.transpose(splat.sh[:, :(splat.sh_degree + 1) ** 2], (0, 2, 1)),
                "antialias_2D_kernel_size": 0.3}  # fmt: skip
