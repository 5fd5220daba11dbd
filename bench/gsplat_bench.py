#!/usr/bin/env python3
"""Times gsplat's forward and backward pass on the scene that gpu_bench --dump wrote.

usage: bench/gsplat_bench.py FOLDER [PATH]     PATH: gsplat's source, where it is not installed
"""

import statistics
import sys
from pathlib import Path


def main():
    folder = Path(sys.argv[1])
    if len(sys.argv) > 2:
        sys.path.insert(0, sys.argv[2])
    try:
        import gsplat
        import numpy
        import torch
    except ImportError as error:
        print(f"gsplat: skipped, {error}")
        return 0
    width, height, fx, fy, cx, cy = (float(word) for word in (folder / "camera.txt").read_text().split())

    def load(name, *shape):
        values = numpy.fromfile(folder / f"{name}.f32", dtype=numpy.float32).reshape(-1, *shape)
        return torch.from_numpy(values).cuda().requires_grad_()

    means, log_scales, quats = load("means", 3), load("log_scales", 3), load("quats", 4)
    logits, sh = load("opacity_logits"), load("sh", 16, 3)
    view = torch.eye(4, device="cuda")[None]
    intrinsics = torch.tensor([[[fx, 0, cx], [0, fy, cy], [0, 0, 1]]], device="cuda", dtype=torch.float32)
    forward, backward = [], []
    for step in range(35):
        marks = [torch.cuda.Event(enable_timing=True) for _ in range(3)]
        marks[0].record()
        image, _, _ = gsplat.rasterization(
            means, quats, log_scales.exp(), logits.sigmoid(), sh, view, intrinsics, int(width), int(height), sh_degree=3
        )
        marks[1].record()
        image.sum().backward()
        marks[2].record()
        torch.cuda.synchronize()
        if step >= 5:
            forward.append(marks[0].elapsed_time(marks[1]))
            backward.append(marks[1].elapsed_time(marks[2]))
    print(f"gsplat {gsplat.__version__}: forward {statistics.median(forward):.3f} ms, backward {statistics.median(backward):.3f} ms")
    return 0


if __name__ == "__main__":
    sys.exit(main())
