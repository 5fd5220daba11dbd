#!/usr/bin/env python3
"""The viewer's server around real runs: finished, going on, killed; its address, its refusals, its end."""

import http.client
import json
import os
import re
import shutil
import signal
import socket
import struct
import subprocess
import time
import urllib.parse

from harness import SMALL_RUN, EndToEnd, command, main

LONG_RUN = [*SMALL_RUN, "--iterations", 1000000, "--threads", 1]
QUIET_BROWSER = ["--no-browser"]


def wait_for(what, seconds=60):
    """The first value of what() that is true."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        value = what()
        if value:
            return value
        time.sleep(0.05)
    raise AssertionError("nothing came within the time")


class View(EndToEnd):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.out = cls.dir / "out"
        subprocess.run(command("reconstruct", cls.scene, "-o", cls.out, "--quiet", *SMALL_RUN), check=True)

    def start(self, *arguments, env=None):
        """A program that goes on, and the address that it prints."""
        process = subprocess.Popen(command(*arguments), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env={**os.environ, **(env or {})})  # fmt: skip
        self.addCleanup(self.end, process)
        for line in process.stdout:
            if line.startswith("viewer "):
                self.assertIn("(open it in a browser)", line)
                return process, urllib.parse.urlparse(line.split()[1]).port
        self.fail(f"no address was printed: {process.stderr.read()}")

    def end(self, process, how=signal.SIGINT):
        """Stops a process; returns its exit code and what it still printed."""
        if process.poll() is None:
            process.send_signal(how)
        rest = process.communicate(timeout=60) if not process.stdout.closed else ("", "")
        return process.returncode, rest

    def get(self, port, path, method="GET"):
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
        connection.putrequest(method, path)  # as it stands: nothing resolves ".." before it is sent
        connection.endheaders()
        answer = connection.getresponse()
        body = answer.read()
        connection.close()
        return answer.status, body, answer

    def live(self, port):
        status, body, _ = self.get(port, "/api/live")
        return json.loads(body) if status == 200 else None

    def document(self, port):
        status, body, _ = self.get(port, "/api/document")
        self.assertEqual(status, 200)
        return json.loads(body)

    def start_long_run(self, out, *arguments):
        run = subprocess.Popen(command("reconstruct", self.scene, "-o", out, *LONG_RUN, *arguments),
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)  # fmt: skip
        self.addCleanup(lambda: (run.kill(), run.wait()))
        return run

    def test_a_finished_run_is_served_until_the_user_ends_it(self):
        process, port = self.start("view", self.out, *QUIET_BROWSER)
        status, page, answer = self.get(port, "/")
        self.assertEqual(status, 200)
        self.assertIn(b"<html", page.lower())
        self.assertIn("default-src 'self'", answer.headers["Content-Security-Policy"])
        document = self.document(port)
        splat = document["splat"]
        status, body, _ = self.get(port, "/files/" + splat["url"])
        self.assertEqual((status, len(body)), (200, splat["bytes"]))
        for path in ["/files/../options.json", "/files/%2e%2e/options.json", "/files/options.json", "/files//etc/passwd"]:
            self.assertEqual(self.get(port, path)[0], 404, path)
        self.assertEqual(self.get(port, "/", "POST")[0], 405)
        code, _ = self.end(process)
        self.assertEqual(code, 0)

    def test_a_splat_file_is_served(self):
        ply = self.dir / "model.ply"
        shutil.copy(self.out / "point_cloud.ply", ply)
        _, port = self.start("view", ply, *QUIET_BROWSER)
        document = self.document(port)
        self.assertEqual(document["kind"], "file")
        self.assertEqual(document["title"], "model.ply")
        status, body, _ = self.get(port, "/files/" + document["splat"]["url"])
        self.assertEqual((status, body[:2]), (200, b"\x1f\x8b"))

    def test_a_closed_terminal_leaves_nothing_behind(self):
        for how in [signal.SIGHUP, signal.SIGTERM]:
            temporary = self.dir / "temporary"
            temporary.mkdir()
            process, port = self.start("view", self.out / "point_cloud.ply", *QUIET_BROWSER, env={"TMPDIR": str(temporary)})
            self.assertEqual(self.get(port, "/")[0], 200)
            self.assertEqual(len(list(temporary.iterdir())), 1)
            code, (_, errors) = self.end(process, how)
            self.assertEqual((code, errors), (0, ""))
            temporary.rmdir()  # it is empty

    def test_a_running_one_is_attached_to_and_seen_to_end(self):
        out = self.dir / "long"
        run = self.start_long_run(out)
        wait_for(lambda: (out / "live/state.json").exists())
        _, port = self.start("view", out, *QUIET_BROWSER)
        first = wait_for(lambda: (state := self.live(port)) and state["splat"] and state["curves"] and state)
        self.assertEqual(first["state"], "running")
        status, body, _ = self.get(port, "/files/" + first["splat"]["url"])
        self.assertEqual((status, len(body) % 32), (200, 0))
        self.assertGreaterEqual(len(body) // 32, 1000)
        positions_and_scales = struct.unpack("<6f", body[:24])
        self.assertTrue(all(abs(x) < 1e6 for x in positions_and_scales))
        self.assertTrue(all(x > 0 for x in positions_and_scales[3:]))
        later = wait_for(lambda: (state := self.live(port)) and state["splat"]["iteration"] > first["splat"]["iteration"] and state)  # fmt: skip
        self.assertEqual(later["state"], "running")
        self.assertEqual([c["name"] for c in later["curves"]], ["loss", "Gaussians"])
        self.error_of("reconstruct", self.scene, "-o", out, *LONG_RUN, code=3, names=["another oraclegs is working"])

        run.kill()
        run.wait()
        ended = self.live(port)
        self.assertEqual(ended["state"], "interrupted")
        self.assertIn("run the same command again", ended["message"])

    def test_an_interrupted_run_says_so_and_a_new_one_is_seen(self):
        out = self.dir / "again"
        run = self.start_long_run(out)
        wait_for(lambda: (out / "train.csv").exists())
        run.send_signal(signal.SIGINT)
        self.assertEqual(run.wait(timeout=60), 130)
        self.assertEqual(json.loads((out / "live/state.json").read_text())["state"], "interrupted")
        process, port = self.start("view", out, *QUIET_BROWSER)
        self.assertEqual(self.live(port)["state"], "interrupted")
        self.start_long_run(out)
        wait_for(lambda: (state := self.live(port)) and state["state"] == "running" and state["splat"])
        self.assertEqual(self.end(process)[0], 0)

    def test_reconstruct_serves_itself_and_ends_where_no_terminal_is(self):
        out = self.dir / "shown"
        process, port = self.start("reconstruct", self.scene, "-o", out, "--view", *QUIET_BROWSER, *LONG_RUN)
        wait_for(lambda: (state := self.live(port)) and state["splat"])
        self.assertEqual(self.get(port, "/")[0], 200)
        code, _ = self.end(process)
        self.assertEqual(code, 130)
        short = ["reconstruct", self.scene, "-o", self.dir / "short", "--view", *QUIET_BROWSER, *SMALL_RUN]
        done = self.run_program(*short)
        self.assertIn("viewer     http://127.0.0.1:", done.stdout)
        self.assertEqual((self.dir / "short/point_cloud.ply").read_bytes(), (self.out / "point_cloud.ply").read_bytes())

    def test_a_taken_port(self):
        with socket.socket() as other:
            other.bind(("127.0.0.1", 0))
            other.listen()
            port = other.getsockname()[1]
            self.error_of("view", self.out, "--port", port, *QUIET_BROWSER, code=2, names=[f"--port {port}: is in use"])
            done = self.run_program("train", self.scene, "-o", self.dir / "taken", "--view", "--port", port, *QUIET_BROWSER, *SMALL_RUN)  # fmt: skip
            self.assertRegex(done.stderr, rf"--port {port}: is in use.*the run goes on without the viewer")
        # Without --port another one is taken.
        _, first = self.start("view", self.out, *QUIET_BROWSER)
        _, second = self.start("view", self.out, *QUIET_BROWSER)
        self.assertNotEqual(first, second)

    def test_what_cannot_be_shown(self):
        self.error_of("view", self.dir / "missing", code=3, names=["does not exist"])
        self.error_of("view", self.scene, code=3, names=["holds no run of oraclegs"])
        (self.dir / "x.txt").write_text("x")
        self.error_of("view", self.dir / "x.txt", code=2, names=["x.txt", ".ply"])
        (self.dir / "empty.ply").write_bytes(b"ply\nformat binary_little_endian 1.0\nelement vertex 0\nproperty float x\nend_header\n")
        self.error_of("view", self.dir / "empty.ply", code=3, names=["empty.ply"])
        broken = self.dir / "broken"
        broken.mkdir()
        (broken / "options.json").write_text("{")
        self.error_of("view", broken, code=3, names=["options.json"])
        self.error_of("view", self.out, "--host", "no.such.host.invalid", code=2, names=["--host"])

    def test_other_addresses_are_warned_of(self):
        process, port = self.start("view", self.out, "--host", "0.0.0.0", *QUIET_BROWSER)
        self.assertEqual(self.get(port, "/api/ping")[0], 200)
        _, (_, errors) = self.end(process)
        self.assertTrue(re.search(r"everyone who reaches port \d+ of this machine can look on", errors), errors)


if __name__ == "__main__":
    main()
