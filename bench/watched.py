"""Runs a program and watches what memory it and the programs that it starts take."""

import os
import subprocess
import sys
import time
from pathlib import Path

POLL = 0.05  # seconds


def status(pid):
    """(name, most bytes that were resident) of a process, as far as it is there."""
    try:
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    except OSError:
        return "", 0
    fields = dict(line.split(":", 1) for line in lines)
    return fields["Name"].strip(), 1024 * int(fields.get("VmHWM", "0").split()[0])


def below(pid):
    """All processes that a process started, directly or not."""
    try:
        files = [Path(f"/proc/{pid}/task/{task}/children") for task in os.listdir(f"/proc/{pid}/task")]
        children = [child for file in files for child in file.read_text().split()]
    except OSError:
        return
    for child in children:
        yield child
        yield from below(child)


def run(command, log, cores=None):
    """Runs a program, its words in a file; returns its exit code, seconds, and peak bytes by name of process.

    The usage that the system reports of a child holds what its parent had when it started it, so the processes are watched.
    """
    print("+", *command, file=sys.stderr, flush=True)
    usable = sorted(os.sched_getaffinity(0))[:cores]
    begin, peaks = time.monotonic(), {}
    with open(log, "w") as out:
        process = subprocess.Popen([str(word) for word in command], stdout=out, stderr=subprocess.STDOUT,
                                   preexec_fn=lambda: os.sched_setaffinity(0, usable))  # fmt: skip
        while process.poll() is None:
            for pid in [process.pid, *below(process.pid)]:
                name, peak = status(pid)
                peaks[name] = max(peaks.get(name, 0), peak)
            time.sleep(POLL)
    return process.returncode, time.monotonic() - begin, peaks
