"""oraclegs.Workspace, read_splat and render: what a run left, as arrays."""

import json
import shutil
import tempfile
import unittest
import warnings
from pathlib import Path

import fixtures
import numpy as np
import oraclegs
from oraclegs import _core


class Workspace(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.workspace = oraclegs.Workspace(fixtures.finished_run())

    def test_has_options_metrics_stages_and_split(self):
        self.assertEqual(self.workspace.options["init"], "random")
        self.assertEqual(len(self.workspace.split["train"]), 6)
        self.assertGreater(self.workspace.metrics["test"]["ssim"], 0)
        self.assertIn("train", self.workspace.stages)

    def test_views_have_cameras_and_images(self):
        self.assertEqual([view.name for view in self.workspace.train_views], self.workspace.split["train"])
        self.assertEqual([view.role for view in self.workspace.views], 6 * ["train"] + 2 * ["test"])
        frames = json.loads((fixtures.scene() / "transforms.json").read_text())
        poses = {frame["file_path"]: np.array(frame["transform_matrix"]) for frame in frames["frames"]}
        for view in self.workspace.views:
            self.assertEqual((view.camera.width, view.camera.height), (64, 48))
            self.assertEqual(view.image.shape, (48, 64, 3))
            self.assertEqual(view.image.dtype, np.float32)
            self.assertIsNone(view.mask)
            np.testing.assert_allclose(view.camera.center, poses[view.name][:3, 3], atol=1e-9)
            np.testing.assert_allclose(view.camera.R[2], -poses[view.name][:3, 2], atol=1e-9)
            self.assertTrue(view.path.is_file())

    def test_renders_what_the_run_rendered(self):
        view = self.workspace.test_views[0]
        image = oraclegs.render(self.workspace.gaussians, view.camera)
        self.assertEqual((image.shape, image.dtype), ((48, 64, 3), np.float32))
        files = sorted(path for path in (self.workspace.path / "renders/test").glob("*.png") if not path.stem.endswith("_gt"))
        stored = _core.read_image(str(files[0]))
        self.assertLessEqual(np.abs(np.clip(image, 0, 1) - stored).max(), 0.5 / 255 + 1e-5)

    def test_curves_are_columns(self):
        curves = self.workspace.curves
        self.assertEqual(curves["iteration"][-1], 60)
        self.assertEqual(curves["gaussians"][-1], len(self.workspace.gaussians))
        self.assertTrue(np.isfinite(curves["loss"]).all())
        self.assertEqual(self.workspace.proposals, [])

    def test_what_is_missing_is_named(self):
        with self.assertRaisesRegex(oraclegs.InputError, "no run of oraclegs"):
            oraclegs.Workspace("/nowhere")
        with self.assertRaisesRegex(oraclegs.InputError, "depth_params.json|depth"):
            self.workspace.train_views[0].depth


class Geometry(unittest.TestCase):
    def test_training_views_have_depth(self):
        out = fixtures.folder() / "geometry"
        options = {**fixtures.SMALL, "iterations": 5, "depth_prior": "stereo"}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            oraclegs.reconstruct(fixtures.scene(), out, **options)
        depth = oraclegs.Workspace(out).train_views[0].depth
        self.assertEqual(depth.inverse_depth.shape, (48, 64))
        self.assertEqual(depth.normals.shape, (48, 64, 3))
        self.assertTrue(((depth.confidence >= 0) & (depth.confidence <= 1)).all())

    def test_proposals_have_cameras_images_and_confidence(self):
        out = fixtures.folder() / "proposals"
        for name in ("proposals", "confidence"):
            (out / name).mkdir(parents=True)
            shutil.copy(fixtures.scene() / "images/000.png", out / name / "orbit_0000.png")
        (out / "options.json").write_text("{}")
        frame = {"file_path": "orbit_0000.png", "transform_matrix": np.eye(4).tolist(), "fl_x": 50, "fl_y": 50, "cx": 32, "cy": 24,
                 "w": 64, "h": 48}  # fmt: skip
        (out / "confidence/transforms.json").write_text(json.dumps({"camera_model": "PINHOLE", "frames": [frame]}))
        (proposal,) = oraclegs.Workspace(out).proposals
        self.assertEqual(proposal.name, "orbit_0000")
        self.assertEqual(proposal.camera.K[0, 0], 50)
        np.testing.assert_allclose(proposal.camera.R, np.diag([1, -1, -1]))
        self.assertEqual(proposal.image.shape, (48, 64, 3))
        self.assertEqual(proposal.confidence.shape, (48, 64))


class Splat(unittest.TestCase):
    def test_reads_every_parameter(self):
        splat = oraclegs.read_splat(fixtures.finished_run() / "point_cloud.ply")
        n = len(splat)
        self.assertGreater(n, 100)
        self.assertEqual([splat.means.shape, splat.log_scales.shape, splat.quats.shape, splat.opacity_logits.shape, splat.sh.shape],
                         [(n, 3), (n, 3), (n, 4), (n,), (n, 16, 3)])  # fmt: skip
        self.assertEqual(splat.support.shape, (n,))
        self.assertEqual(splat.uncertainty.shape, (n,))
        self.assertTrue(((splat.opacities >= 0) & (splat.opacities <= 1)).all())

    def test_what_is_left_out_is_a_warning(self):
        header, body = (fixtures.finished_run() / "point_cloud.ply").read_bytes().split(b"end_header\n", 1)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "odd.ply"
            nan = np.array([np.nan], "<f4").tobytes()
            path.write_bytes(header + b"comment SplatRenderMode: mip\nend_header\n" + nan + body[4:])
            with self.assertWarnsRegex(UserWarning, "1 of [0-9]+ Gaussians"):
                splat = oraclegs.read_splat(path)
        self.assertEqual(len(splat), len(oraclegs.read_splat(fixtures.finished_run() / "point_cloud.ply")) - 1)
        self.assertTrue(splat.antialiased)

    def test_renders_from_matrices_and_one_gaussian_where_it_is(self):
        one = oraclegs.Splat(np.array([[0, 0, 4]]), np.full((1, 3), -2.0), np.array([[1, 0, 0, 0]]), np.array([5.0]),
                             np.concatenate([np.ones((1, 1, 3)), np.zeros((1, 15, 3))], axis=1))  # fmt: skip
        k = np.array([[50, 0, 16], [0, 50, 12], [0, 0, 1]])
        image = oraclegs.render(one, (k, np.eye(4), 32, 24), background=(0.25, 0.25, 0.25))
        self.assertEqual(np.unravel_index(image[..., 0].argmax(), (24, 32)), (11, 15))
        np.testing.assert_allclose(image[0, 0], 0.25, atol=1e-6)
        self.assertAlmostEqual(image[11, 15, 0], 0.5 + 0.2821, delta=0.05)

    def test_refuses_what_is_no_camera_or_no_splat(self):
        splat = oraclegs.read_splat(fixtures.finished_run() / "point_cloud.ply")
        k = np.diag([50.0, 50.0, 1.0])
        with self.assertRaisesRegex(oraclegs.InputError, "rotation"):
            oraclegs.render(splat, (k, 2 * np.eye(4), 32, 24))
        with self.assertRaisesRegex(ValueError, r"shape \(4, 4\)"):
            oraclegs.render(splat, (k, np.eye(3), 32, 24))
        splat.quats = splat.quats[:, :3]
        with self.assertRaisesRegex(ValueError, r"quats has shape \(\d+, 3\), expected \(\d+, 4\)"):
            oraclegs.render(splat, (k, np.eye(4), 32, 24))
        with self.assertRaisesRegex(oraclegs.InputError, "none.ply"):
            oraclegs.read_splat("/none.ply")


if __name__ == "__main__":
    unittest.main()
