#!/usr/bin/env python3
"""`oraclegs models` against a real HTTP server on the loopback interface that misbehaves in every usual way."""

import hashlib
import http.server
import json
import os
import shutil
import signal
import struct
import subprocess
import tempfile
import threading
import unittest
from pathlib import Path

from harness import EndToEnd, command, main
from torch_files import state_dict, tensor, zipped

NAME = "vggt-commercial"  # the checksum of its file is the server's
VGGT = "/facebook/VGGT-1B-Commercial/resolve/ebb29a532abe92960eeb6903a5530f16990ef4ab/model.safetensors"
LPIPS = "/models/alexnet-owt-7be5be79.pth"
TOKEN = "hf_secret"


def safetensors(values):
    """A file of one tensor."""
    header = json.dumps({"x": {"dtype": "F32", "shape": [len(values)], "data_offsets": [0, 4 * len(values)]}}).encode()
    return struct.pack("<Q", len(header)) + header + struct.pack(f"<{len(values)}f", *values)


FILE = safetensors(range(50_000))  # more than a socket holds
SHA256 = hashlib.sha256(FILE).hexdigest()


class Server:
    """Answers with `answer(handler, path)`; `requests` are [(path, headers)]."""

    def __init__(self, answer):
        self.requests = requests = []

        class Handler(http.server.BaseHTTPRequestHandler):
            def do_GET(self):
                requests.append((self.path, dict(self.headers)))
                answer(self, self.path)

            def log_message(self, *_):
                pass

        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.server.daemon_threads = True
        self.url = f"http://127.0.0.1:{self.server.server_address[1]}"
        self.thread = threading.Thread(target=self.server.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True)

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.server.shutdown()
        self.server.server_close()

    def ranges(self):
        return [headers.get("Range") for _, headers in self.requests]


def begin(handler, status, length, **headers):
    handler.send_response(status)
    for name, value in headers.items():
        handler.send_header(name.replace("_", "-"), value)
    handler.send_header("Content-Length", str(length))
    handler.end_headers()


def start_of(handler):
    """Where the wanted range begins."""
    wanted = handler.headers.get("Range")
    return int(wanted.removeprefix("bytes=").removesuffix("-")) if wanted else 0


def send(handler, content, until=None, etag=None, **headers):
    """The wanted range of a file; with `until` the connection is lost before that byte."""
    start = start_of(handler)
    if etag:
        headers["X_Linked_Etag"] = f'"{etag}"'
    if start:
        headers["Content_Range"] = f"bytes {start}-{len(content) - 1}/{len(content)}"
    begin(handler, 206 if start else 200, len(content) - start, **headers)
    handler.wfile.write(content[start:until])
    handler.close_connection = True


class Models(EndToEnd):
    @classmethod
    def setUpClass(cls):
        cls.dir = Path(tempfile.mkdtemp(prefix="oraclegs_models_"))
        cls.addClassCleanup(shutil.rmtree, cls.dir, ignore_errors=True)

    def setUp(self):
        self.cache = self.dir / self.id().rsplit(".", 1)[1]
        self.env = {name: value for name, value in os.environ.items() if "proxy" not in name.lower()}
        self.env |= {"ORACLEGS_MODELS": str(self.cache), "HF_TOKEN": TOKEN}

    def use(self, server):
        self.env["ORACLEGS_MODELS_URL"] = server.url

    def fetch(self, name=NAME, *arguments, code=0):
        return self.run_program("models", "fetch", name, "--accept-license", *arguments, code=code, env=self.env)

    def fails(self, name, code, *names):
        line = self.error_of("models", "fetch", name, "--accept-license", code=code, names=names, env=self.env)
        self.assertFalse((self.cache / name / "model.safetensors").exists())
        return line

    def fetched(self, name=NAME):
        return self.cache / name / "model.safetensors"

    def test_fetch_list_and_find_again(self):
        with Server(lambda handler, _: send(handler, FILE, etag=SHA256)) as server:
            self.use(server)
            done = self.fetch()
            self.assertEqual(done.stdout.strip(), str(self.fetched()))
            self.assertIn("vggt-commercial: license VGGT License; its acceptable use policy", done.stderr)
            self.assertNotIn("its checksum is not known", done.stderr)
            self.assertIn("does not hold vggt-commercial; 1341 missing", done.stderr)  # it is whole, but no VGGT
            self.fetch()
        self.assertEqual(self.fetched().read_bytes(), FILE)
        self.assertEqual([path.name for path in self.fetched().parent.iterdir()], ["model.safetensors"])
        self.assertEqual([path for path, _ in server.requests], [VGGT])  # nothing is fetched twice
        text = self.run_program("models", "list", env=self.env).stdout
        self.assertRegex(text, r"\nvggt-commercial +5\.03 GB  yes ")
        self.assertRegex(text, r"\nseva +5\.06 GB  no ")
        for words in ["https://huggingface.co" + VGGT, "license Apache-2.0\n", str(self.fetched())]:
            self.assertIn(words, text)
        line = self.error_of("models", "check", NAME, code=3, names=[self.fetched(), "1341 missing"], env=self.env)
        self.assertIn("1 that are no part of it: x", line)

    def test_the_license_comes_first(self):
        with Server(lambda handler, _: send(handler, FILE)) as server:
            self.use(server)
            self.error_of("models", "fetch", "seva", code=2, env=self.env,
                          names=["Non-Commercial", "the images that the network makes", "--accept-license"])  # fmt: skip
        self.assertEqual(server.requests, [])

    def test_a_lost_connection_is_taken_up_again(self):
        with Server(lambda handler, _: send(handler, FILE, start_of(handler) + 60_000, SHA256)) as server:
            self.use(server)
            self.assertIn("going on from byte 60000", self.fetch().stderr)
        self.assertEqual(self.fetched().read_bytes(), FILE)
        self.assertEqual(server.ranges(), [None, "bytes=60000-", "bytes=120000-", "bytes=180000-"])

    def test_a_killed_download_continues(self):
        enough = threading.Event()

        def stalls(handler, _):
            begin(handler, 200, len(FILE), X_Linked_Etag=f'"{SHA256}"')
            handler.wfile.write(FILE[:100_000])
            handler.wfile.flush()
            enough.wait(60)

        part = self.cache / NAME / "model.safetensors.part"
        for how, code in [(signal.SIGINT, 130), (signal.SIGKILL, -signal.SIGKILL)]:
            with Server(stalls) as server:
                self.use(server)
                arguments = command("models", "fetch", NAME, "--accept-license")
                process = subprocess.Popen(arguments, env=self.env, stderr=subprocess.PIPE, text=True)
                while process.poll() is None and not (part.exists() and part.stat().st_size == 100_000):
                    enough.wait(0.01)
                process.send_signal(how)
                process.communicate()
                self.assertEqual(process.returncode, code)
                enough.set()
            enough.clear()
            self.assertEqual(part.read_bytes(), FILE[:100_000])
            self.assertFalse(self.fetched().exists())
            part.write_bytes(FILE[:50_000])
        with Server(lambda handler, _: send(handler, FILE, etag=SHA256)) as server:
            self.use(server)
            self.fetch()
        self.assertEqual(server.ranges(), ["bytes=50000-"])
        self.assertEqual(self.fetched().read_bytes(), FILE)

    def test_a_server_that_ignores_ranges(self):
        def whole(handler, _):
            begin(handler, 200, len(FILE))
            handler.wfile.write(FILE)

        (self.cache / NAME).mkdir(parents=True)
        (self.cache / NAME / "model.safetensors.part").write_bytes(FILE[:5000])
        with Server(whole) as server:
            self.use(server)
            self.assertIn("its checksum is not known", self.fetch().stderr)
        self.assertEqual(self.fetched().read_bytes(), FILE)

    def test_truncated_for_good(self):
        def cut(handler, _):
            if start_of(handler) >= 70_000:
                begin(handler, 206, len(FILE) - start_of(handler),
                      Content_Range=f"bytes {start_of(handler)}-{len(FILE) - 1}/{len(FILE)}")  # fmt: skip
            else:
                send(handler, FILE, 70_000, SHA256)
            handler.close_connection = True

        with Server(cut) as server:
            self.use(server)
            self.fails(NAME, 4, f"after 70000 of {len(FILE)} bytes; the same command continues")

    def test_wrong_checksums(self):
        with Server(lambda handler, _: send(handler, FILE, etag="0" * 64)) as server:
            self.use(server)
            self.fails(NAME, 4, f"its SHA-256 is {SHA256}, expected {'0' * 64}")
        self.assertEqual(list((self.cache / NAME).iterdir()), [])
        # Where we know the checksum and the length ourselves, the server has no say.
        with Server(lambda handler, _: send(handler, FILE, etag=SHA256)) as server:
            self.use(server)
            self.fails("lpips-alex", 4, LPIPS, f"the server has a file with SHA-256 {SHA256}, expected 7be5be79")
        with Server(lambda handler, _: send(handler, FILE)) as server:
            self.use(server)
            self.fails("lpips-alex", 4, f"the server has {len(FILE)} bytes, expected 244408911")

    def test_another_host_gets_no_token(self):
        with Server(lambda handler, _: send(handler, FILE)) as other:
            def redirect(handler, path):
                if path == VGGT:
                    begin(handler, 307, 0, Location="/api/resolve-cache" + path)
                else:
                    begin(handler, 302, 0, Location=other.url + "/blob?signature=abc", X_Linked_Etag=f'"{SHA256}"')

            with Server(redirect) as server:
                self.use(server)
                stderr = self.fetch().stderr
        self.assertEqual(self.fetched().read_bytes(), FILE)
        self.assertNotIn("its checksum is not known", stderr)
        self.assertEqual([headers.get("Authorization") for _, headers in server.requests], [f"Bearer {TOKEN}"] * 2)
        self.assertEqual([path for path, _ in other.requests], ["/blob?signature=abc"])
        self.assertNotIn(TOKEN, str(other.requests))

    def test_refusals(self):
        for status, words, code in [(401, ["(401)", "set HF_TOKEN"], 3), (403, ["(403)", "agree to the license"], 3),
                                    (404, ["(404)", "docs/models.md"], 3), (503, ["(503)", "try again later"], 4)]:  # fmt: skip
            with Server(lambda handler, _, status=status: begin(handler, status, 0)) as server:
                self.use(server)
                self.fails("seva", code, *words)
        self.env["ORACLEGS_MODELS_URL"] = server.url  # nobody listens there any more
        self.fails("seva", 4, "no answer", "https_proxy")
        self.env["ORACLEGS_MODELS_URL"] = "nowhere"
        self.fails("seva", 2, "ORACLEGS_MODELS_URL is 'nowhere'")

    def test_a_proxy_is_used_and_nothing_secret_goes_over_plain_http(self):
        with Server(lambda handler, _: begin(handler, 404, 0)) as proxy:
            self.env |= {"http_proxy": proxy.url, "ORACLEGS_MODELS_URL": "http://models.invalid"}
            self.fails("seva", 3, "(404)")
        self.assertTrue(proxy.requests[0][0].startswith("http://models.invalid/stabilityai/"), proxy.requests)
        self.assertNotIn(TOKEN, str(proxy.requests))

    def test_a_file_without_a_known_checksum_comes_from_no_mirror(self):
        self.env["ORACLEGS_MODELS_URL"] = "https://models.invalid"
        self.fails(NAME, 2, "checksum is not known", "ORACLEGS_MODELS_URL")

    def test_a_folder_that_cannot_be_written(self):
        self.dir.joinpath("file").write_text("x")
        self.env |= {"ORACLEGS_MODELS": str(self.dir / "file/in"), "ORACLEGS_MODELS_URL": "http://127.0.0.1:1"}
        self.error_of("models", "fetch", "seva", "--accept-license", code=4, names=["file/in/seva"], env=self.env)

    def test_published_files_that_cannot_be_converted(self):
        name = "depth-anything-v2-small"
        published = self.cache / name / "depth_anything_v2_vits.pth"
        published.parent.mkdir(parents=True)
        with Server(lambda handler, _: begin(handler, 404, 0)) as server:
            self.use(server)
            for content, said in [(zipped(state_dict(a=tensor([1], (1,)))), f"cannot be converted to {name}"),
                                  (b"\x80\x02cos\nsystem\n." + b" " * 16, "os system")]:  # fmt: skip
                published.write_bytes(content)
                self.fails(name, 4, "cannot convert its files", published, said, "remove them from")
                self.assertEqual(published.read_bytes(), content)
        self.assertEqual(server.requests, [])  # what is here is not fetched again

    def test_check_of_a_file_that_fits(self):
        shapes = {"features.0": (64, 3, 11, 11), "features.3": (192, 64, 5, 5), "features.6": (384, 192, 3, 3),
                  "features.8": (256, 384, 3, 3), "features.10": (256, 256, 3, 3)}  # fmt: skip
        tensors = {f"{name}.weight": shape for name, shape in shapes.items()}
        tensors |= {f"{name}.bias": shape[:1] for name, shape in shapes.items()}
        tensors |= {f"lin{i}.model.1.weight": (1, shape[0], 1, 1) for i, shape in enumerate(shapes.values())}
        file = self.dir / "alex.safetensors"

        def write(tensors):
            header, position = {}, 0
            for name, shape in tensors.items():
                size = 2
                for side in shape:
                    size *= side
                header[name] = {"dtype": "F16", "shape": shape, "data_offsets": [position, position + size]}
                position += size
            text = json.dumps(header).encode()
            with open(file, "wb") as out:
                out.write(struct.pack("<Q", len(text)) + text)
                out.truncate(8 + len(text) + position)  # zeros that take no space

        write(tensors)
        done = self.run_program("models", "check", "lpips-alex", "--file", file, env=self.env)
        self.assertEqual(done.stdout, f"{file}: all 15 tensors of lpips-alex are there\n")
        tensors["features.0.bias"] = (63,)
        del tensors["lin4.model.1.weight"]
        write(tensors)
        self.error_of("models", "check", "lpips-alex", "--file", file, code=3, env=self.env,
                      names=["1 missing: lin4.model.1.weight", "features.0.bias is [63], expected [64]"])  # fmt: skip
        self.error_of("models", "check", "lpips-alex", code=3, env=self.env,
                      names=["the weights of lpips-alex are not here; `oraclegs models fetch lpips-alex`"])  # fmt: skip

    def test_mistakes_on_the_command_line(self):
        for arguments, words in [([], ["action"]), (["get"], ["models get", "list, fetch NAME, check NAME and convert FILE..."]),
                                 (["list", "seva"], ["takes no name"]), (["fetch"], ["needs a name"]),
                                 (["check"], ["needs a name"]), (["fetch", "vgt"], ["'vgt'", "vggt-commercial"])]:  # fmt: skip
            self.error_of("models", *arguments, code=2, names=words, env=self.env)
        self.env["HF_TOKEN"] = "a b"
        self.error_of("models", "fetch", "seva", "--accept-license", code=2, names=["HF_TOKEN"], env=self.env)


if __name__ == "__main__":
    main()
