"""scripts/datasets.sh on archives of a folder."""

import hashlib
import http.server
import json
import math
import os
import re
import subprocess
import tempfile
import threading
import unittest
import zipfile
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "scripts/datasets.sh"
MIPNERF360 = "bicycle bonsai counter garden kitchen room stump".split()


def projection(number):
    """A camera on a circle that looks at the origin: P = K [R | t], times a factor that means nothing."""
    angle = 0.1 * number
    c, s = math.cos(angle), math.sin(angle)
    rotation = [[c, 0, -s], [0, 1, 0], [s, 0, c]]
    t = [1.0, 2.0, 600.0]
    k = [[2900, 0, 820], [0, 2890, 610], [0, 0, 1]]
    rt = [row + [x] for row, x in zip(rotation, t)]
    return [[-0.5 * sum(k[i][m] * rt[m][j] for m in range(3)) for j in range(4)] for i in range(3)]


class Datasets(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory(prefix="oraclegs_datasets_")
        self.addCleanup(place.cleanup)
        self.place, self.to = Path(place.name), Path(place.name) / "data sets"
        self.archives = self.place / "archives"
        self.archives.mkdir()

    def archive(self, name, files):
        with zipfile.ZipFile(self.archives / name, "w") as archive:
            for path, content in files.items():
                archive.writestr(path, content)

    def mipnerf360(self, content="photo"):
        files = {f"{s}/{f}": content for s in MIPNERF360 for f in ("images/1.JPG", "images_4/1.JPG", "sparse/0/cameras.bin")}
        self.archive("360_v2.zip", {**files, "flowers.txt": "to ask for"})

    def run_script(self, *arguments, source=None, code=0):
        command = [SCRIPT, "--to", self.to, "--from", source or self.archives.as_uri(), *arguments]
        run = subprocess.run(command, capture_output=True, text=True)
        self.assertEqual(run.returncode, code, run.stdout + run.stderr)
        if code:
            self.assertEqual(run.stderr.count("\n"), 1, run.stderr)
            self.assertTrue(run.stderr.startswith("scripts/datasets.sh: "), run.stderr)
        return run.stdout + run.stderr

    def test_lays_a_dataset_out_and_fetches_it_once(self):
        self.mipnerf360()
        said = self.run_script("mipnerf360")
        self.assertIn("nobody has published it", said)
        for scene in MIPNERF360:
            self.assertEqual((self.to / "mipnerf360" / scene / "images_4/1.JPG").read_text(), "photo")
            self.assertTrue((self.to / "mipnerf360" / scene / "sparse/0/cameras.bin").exists())
        self.assertFalse((self.to / ".archives").exists())
        self.assertIn("is there", self.run_script("mipnerf360", source="file:///nowhere"))

    def test_checks_later_downloads_against_the_first(self):
        self.mipnerf360()
        self.run_script("mipnerf360", "--scenes", "garden,room")
        self.assertEqual(sorted(p.name for p in (self.to / "mipnerf360").iterdir() if p.is_dir()), ["garden", "room"])
        self.mipnerf360("another photo")
        self.assertIn("expected", self.run_script("mipnerf360", code=4))
        self.assertFalse((self.to / "mipnerf360/stump").exists())

    def test_a_damaged_first_download_is_not_the_one_to_compare_with(self):
        self.mipnerf360("photo" * 1000)
        whole = (self.archives / "360_v2.zip").read_bytes()
        for damaged in (whole[:500], whole[:1000] + b"damage" + whole[1006:]):
            (self.archives / "360_v2.zip").write_bytes(damaged)
            said = self.run_script("mipnerf360", code=4)
            self.assertRegex(said, "360_v2.zip: is (no zip archive|damaged .*); remove it")
            self.assertFalse((self.to / "mipnerf360/360_v2.zip.sha256").exists())
            (self.to / ".archives/360_v2.zip").unlink()
        (self.archives / "360_v2.zip").write_bytes(whole)
        self.assertIn("nobody has published it", self.run_script("mipnerf360", "--scenes", "room"))
        self.mipnerf360("another photo")
        self.assertIn("mipnerf360/360_v2.zip.sha256); it is now", self.run_script("mipnerf360", code=4))

    def test_refuses_what_has_another_checksum_than_the_published_one(self):
        self.archive("nerf_synthetic.zip", {"nerf_synthetic/lego/transforms_train.json": "{}"})
        found = hashlib.sha256((self.archives / "nerf_synthetic.zip").read_bytes()).hexdigest()
        self.assertIn(f"has sha256 {found}, expected f01fd1b4", self.run_script("blender", code=4))

    def test_goes_on_with_a_download(self):
        self.mipnerf360()
        whole = (self.archives / "360_v2.zip").read_bytes()
        (self.to / ".archives").mkdir(parents=True)
        (self.to / ".archives/360_v2.zip.part").write_bytes(whole[:500])
        self.run_script("mipnerf360", "--keep")
        self.assertEqual((self.to / ".archives/360_v2.zip").read_bytes(), whole)

    def test_takes_a_whole_download_of_a_server_that_tells_no_length(self):
        self.mipnerf360()
        whole = (self.archives / "360_v2.zip").read_bytes()

        class NoLength(http.server.BaseHTTPRequestHandler):
            def do_HEAD(self):
                self.send_response(405)
                self.end_headers()

            def do_GET(self):
                self.send_response(416 if "Range" in self.headers else 200)
                self.end_headers()
                if "Range" not in self.headers:
                    self.wfile.write(whole)

            def log_message(self, *_):
                pass

        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), NoLength)
        self.addCleanup(server.server_close)
        self.addCleanup(server.shutdown)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        source = f"http://127.0.0.1:{server.server_port}"
        (self.to / ".archives").mkdir(parents=True)
        (self.to / ".archives/360_v2.zip.part").write_bytes(whole)
        self.run_script("mipnerf360", source=source)
        self.assertTrue((self.to / "mipnerf360/room").exists())

    def test_takes_the_fox_out_of_its_repository(self):
        root = "instant-ngp-master"
        self.archive("instant-ngp.zip", {f"{root}/data/nerf/fox/images/0001.jpg": "photo",
                                         f"{root}/data/nerf/fox/transforms.json": "{}", f"{root}/src/main.cu": "code"})
        self.run_script("fox")
        scene = self.to / "fox/fox"
        self.assertEqual((scene / "images/0001.jpg").read_text(), "photo")
        self.assertEqual(sorted(p.name for p in scene.iterdir()), ["images", "transforms.json"])

    def test_makes_scenes_of_dtu(self):
        self.archive("SampleSet.zip", {f"SampleSet/MVS Data/Calibration/cal18/pos_{n:03d}.txt":
                                       "\n".join(" ".join(map(repr, row)) for row in projection(n)) for n in range(1, 65)})
        self.archive("Rectified.zip", {f"Rectified/scan8/rect_{n:03d}_{light}_r5000.png": f"{n} {light}"
                                       for n in range(1, 50) for light in range(7)})
        self.run_script("dtu", "--scenes", "scan8")
        scene = self.to / "dtu/scan8"
        frames = json.loads((scene / "transforms.json").read_text())["frames"]
        self.assertEqual(len(frames), 49)
        self.assertEqual((scene / frames[6]["file_path"]).read_text(), "7 3")
        point = (10.0, -20.0, 30.0)
        for number, frame in enumerate(frames, 1):
            image = [sum(a * b for a, b in zip(row, (*point, 1))) for row in projection(number)]
            m = frame["transform_matrix"]
            moved = [p - m[i][3] for i, p in enumerate(point)]
            x, y, z = (sum(m[i][j] * moved[i] for i in range(3)) for j in range(3))
            self.assertAlmostEqual(frame["fl_x"] * x / -z + frame["cx"], image[0] / image[2], places=6)
            self.assertAlmostEqual(frame["fl_y"] * -y / -z + frame["cy"], image[1] / image[2], places=6)
            self.assertLess(z, 0)

    def test_says_in_one_line_what_is_wrong(self):
        self.assertIn("there is no dataset 'tandt'", self.run_script("tandt", code=2))
        self.assertIn("has no scene 'truck'", self.run_script("llff", "--scenes", "truck", code=2))
        self.assertIn("name a dataset", self.run_script(code=2))
        said = self.run_script("llff", source="http://127.0.0.1:1", code=4)
        self.assertRegex(said, "(?m)^scripts/datasets.sh: http://127.0.0.1:1/nerf_llff_data.zip: .*the same command goes on")
        self.archive("360_v2.zip", {"bicycle/a": ""})
        self.assertIn("bonsai: is not in", self.run_script("mipnerf360", code=4))
        blocked = self.place / "file"
        blocked.write_text("")
        run = subprocess.run([SCRIPT, "--to", blocked, "llff"], capture_output=True, text=True)
        self.assertIn("cannot be made or written", run.stderr)

    @unittest.skipUnless(os.geteuid() == 0 and Path("/proc/self/mounts").exists(), "needs root for a small file system")
    def test_a_full_disk_is_named(self):
        self.to.mkdir()
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", self.to], capture_output=True).returncode:
            self.skipTest("cannot mount a tmpfs here")
        self.addCleanup(subprocess.run, ["umount", self.to])
        self.archive("360_v2.zip", {f"{s}/images/1.JPG": os.urandom(300000) for s in MIPNERF360})
        self.assertRegex(self.run_script("mipnerf360", code=4), "360_v2.zip needs 3 MB and . MB are free; make room")

    def test_lists_and_helps(self):
        listed = subprocess.run([SCRIPT, "--list"], capture_output=True, text=True, check=True).stdout
        for url in re.findall(r"https?://\S+\.zip", listed):
            self.assertIn(url.rsplit("/", 1)[-1], ("360_v2.zip", "nerf_synthetic.zip", "nerf_llff_data.zip", "SampleSet.zip", "Rectified.zip"))
        self.assertIn("--scenes A,B", subprocess.run([SCRIPT, "--help"], capture_output=True, text=True, check=True).stdout)


if __name__ == "__main__":
    unittest.main()
