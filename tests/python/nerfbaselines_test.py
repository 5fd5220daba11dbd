"""oraclegs.nerfbaselines against a stand-in for the interface that NerfBaselines publishes."""

import dataclasses
import importlib.util
import inspect
import json
import sys
import types
import unittest
from pathlib import Path

import fixtures
import numpy as np
import oraclegs


class Method:  # what NerfBaselines calls, with its parameters
    def __init__(self, *, checkpoint=None, train_dataset=None, config_overrides=None):
        pass

    def get_train_embedding(self, index):
        return None


@dataclasses.dataclass(frozen=True)
class Cameras:
    poses: np.ndarray
    intrinsics: np.ndarray
    camera_models: np.ndarray
    distortion_parameters: np.ndarray
    image_sizes: np.ndarray
    nears_fars: object = None
    metadata: object = None

    def item(self):
        return self if self.poses.ndim == 2 else self[0]

    def __getitem__(self, i):
        return Cameras(self.poses[i], self.intrinsics[i], self.camera_models[i], self.distortion_parameters[i], self.image_sizes[i])


registered = []
stub = types.ModuleType("nerfbaselines")
stub.Method, stub.register = Method, registered.append
sys.modules["nerfbaselines"] = stub

from oraclegs.nerfbaselines import OracleGS, write_scene  # noqa: E402


def dataset(names=slice(None), **changes):
    views = sorted(oraclegs.Workspace(fixtures.finished_run()).views, key=lambda view: view.name)[names]
    poses = np.stack([np.linalg.inv(v.camera.world_to_camera)[:3] for v in views]).astype(np.float32)
    intrinsics = np.stack([[v.camera.K[0, 0], v.camera.K[1, 1], v.camera.K[0, 2], v.camera.K[1, 2]] for v in views])
    sizes = np.array([[v.camera.width, v.camera.height] for v in views], np.int32)
    cameras = Cameras(poses, intrinsics, np.zeros(len(views), np.int32), np.zeros((len(views), 0)), sizes)
    images = [np.rint(v.image * 255).astype(np.uint8) for v in views]
    # Images are padded to one size, as NerfBaselines may have them.
    images = [np.pad(image, ((0, 3), (0, 5), (0, 0))) for image in images]
    return {"cameras": cameras, "images": images, "image_paths": [v.name for v in views], "image_paths_root": "/",
            "sampling_masks": None, "points3D_xyz": None, "points3D_rgb": None, "metadata": {"id": "demo"}, **changes}  # fmt: skip


OPTIONS = {key: value for key, value in fixtures.SMALL.items() if key != "test_every"}


class NerfBaselines(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.method = OracleGS(train_dataset=dataset(), config_overrides={**OPTIONS, "iterations": "120"})
        cls.metrics = cls.method.train_iteration(0)

    def test_has_the_interface(self):
        for name, parameters in {"get_info": [], "train_iteration": ["step"], "render": ["camera", "options"], "save": ["path"],
                                 "export_gaussian_splats": ["options"]}.items():  # fmt: skip
            self.assertEqual(list(inspect.signature(getattr(self.method, name)).parameters), parameters)
        info = OracleGS.get_method_info()
        self.assertEqual(info["method_id"], "oraclegs")
        self.assertEqual(info["supported_camera_models"], frozenset(("pinhole",)))
        model = self.method.get_info()
        self.assertEqual((model["num_iterations"], model["loaded_step"], model["hparams"]["iterations"]), (1, None, "120"))

    def test_trains_and_renders_in_the_cameras_of_the_dataset(self):
        data = dataset()
        errors, others = [], []
        for i in range(8):
            image = self.method.render(data["cameras"][i : i + 1])["color"]
            self.assertEqual(image.shape, (48, 64, 3))
            errors.append(np.mean((image - data["images"][i][:48, :64] / 255.0) ** 2))
            others.append(np.mean((image - data["images"][(i + 4) % 8][:48, :64] / 255.0) ** 2))
        self.assertGreater(-10 * np.log10(np.mean(errors)), 14)
        self.assertLess(np.mean(errors), 0.7 * np.mean(others))
        self.assertGreater(self.metrics["gaussians"], 0)
        self.assertGreater(self.metrics["train_seconds"], 0)

    def test_a_checkpoint_renders_the_same(self):
        path = fixtures.folder() / "checkpoint"
        self.method.save(str(path))
        loaded = OracleGS(checkpoint=str(path))
        self.assertEqual(loaded.get_info()["loaded_step"], 1)
        camera = dataset()["cameras"][2:3]
        np.testing.assert_array_equal(loaded.render(camera)["color"], self.method.render(camera)["color"])
        loaded.save(str(path))  # over itself
        with self.assertRaisesRegex(RuntimeError, "no training dataset"):
            loaded.train_iteration(1)

    def test_exports_the_splat(self):
        splat = self.method.export_gaussian_splats()
        count = len(splat["means"])
        self.assertEqual(splat["opacities"].shape, (count, 1))
        self.assertEqual(splat["spherical_harmonics"].shape[:2], (count, 3))
        np.testing.assert_allclose(np.linalg.norm(splat["quaternions"], axis=1), 1, rtol=1e-5)

    def test_composites_transparent_images_and_keeps_masks(self):
        rgba = np.zeros((48, 64, 4), np.uint8)
        rgba[:, :32] = (200, 100, 0, 255)
        rgba[0, 0] = (200, 100, 0, 128)
        mask = np.arange(64)[None] < np.full((48, 1), 10)
        data = dataset(slice(0, 1), images=[rgba], sampling_masks=[mask], metadata={"background_color": np.array([255] * 3, np.uint8)})
        method = OracleGS(train_dataset=data)
        self.assertEqual(method.get_info()["hparams"]["background"], "white")
        scene = fixtures.folder() / "white"
        write_scene(data, scene, "white")
        image = self.pixels(scene / "images/00000.png")
        self.assertEqual(image[5, 3].tolist(), [200, 100, 0])
        self.assertEqual(image[5, 40].tolist(), [255, 255, 255])
        self.assertEqual(image[0, 0].tolist(), [227, 177, 127])
        self.assertEqual(self.pixels(scene / "masks/00000.png")[0, 9:11, 0].tolist(), [255, 0])

    @staticmethod
    def pixels(path):
        import struct
        import zlib

        data = path.read_bytes()
        width, height = struct.unpack(">II", data[16:24])
        start = data.index(b"IDAT") + 4
        (size,) = struct.unpack(">I", data[start - 8 : start - 4])
        return np.frombuffer(zlib.decompress(data[start : start + size]), np.uint8).reshape(height, 1 + 3 * width)[:, 1:].reshape(height, width, 3)

    def test_refuses_distorted_cameras(self):
        data = dataset(slice(0, 1))
        bent = dataclasses.replace(data["cameras"], camera_models=np.ones(1, np.int32))
        with self.assertRaisesRegex(ValueError, "pinhole"):
            OracleGS(train_dataset={**data, "cameras": bent})
        with self.assertRaisesRegex(ValueError, "pinhole"):
            self.method.render(bent)

    def test_names_an_unknown_background(self):
        data = dataset(slice(0, 1), images=[np.zeros((40, 60, 4), np.uint8)])
        with self.assertRaisesRegex(ValueError, "background is 'pink', must be one of black, gray, white"):
            OracleGS(train_dataset=data, config_overrides={"background": "pink"})

    def test_the_spec_names_the_class(self):
        path = Path(oraclegs.__file__).parent / "nerfbaselines_spec.py"
        spec = importlib.util.spec_from_file_location("spec", path)
        spec.loader.exec_module(importlib.util.module_from_spec(spec))
        (method,) = registered
        module, name = method["method_class"].split(":")
        self.assertIs(getattr(sys.modules[module], name), OracleGS)
        self.assertEqual(set(method["supported_camera_models"]), set(OracleGS.get_method_info()["supported_camera_models"]))
        json.dumps(method)


if __name__ == "__main__":
    unittest.main()
