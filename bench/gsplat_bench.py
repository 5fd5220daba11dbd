#!/usr/bin/env python3
"""Times gsplat on the scene that gpu_bench --dump wrote, beside our own numbers of the same run (FOLDER/ours.json).

usage: bench/gsplat_bench.py FOLDER [PATH]     PATH: gsplat's source, where it is not installed

Two measures: the rasteriser alone (forward, backward), and a training iteration as gsplat's own trainer makes it:
rasterise, L1 + SSIM, backward, one fused Adam for each group of parameters, MCMC's noise. Prints one line. Where gsplat
does not import it says so, and the exit code is 0.
"""

import json
import statistics
import sys
from pathlib import Path

WARM_UP, PASSES = 5, 30
RATES = {"means": 1.6e-6, "log_scales": 5e-3, "quats": 1e-3, "opacity_logits": 5e-2, "sh0": 2.5e-3, "sh_rest": 1.25e-4}


def line(version, theirs, ours):
    """The result. theirs: median milliseconds of forward, backward, iteration; ours: what gpu_bench wrote, or None."""
    text = f"gsplat {version}: forward {theirs['forward']:.3f} ms, backward {theirs['backward']:.3f} ms, iteration {theirs['iteration']:.3f} ms"
    if ours is None:
        return text
    factors = {name: theirs[name] / ours[f"{name}_ms"] if ours[f"{name}_ms"] > 0 else 0 for name in ("forward", "iteration")}
    return (
        f"{text}; ours: forward {ours['forward_ms']:.3f} ms, {factors['forward']:.2f} times as fast, "
        f"iteration {ours['iteration_ms']:.3f} ms, {factors['iteration']:.2f} times as fast"
    )


def read_camera(folder):
    width, height, fx, fy, cx, cy = (float(word) for word in (folder / "camera.txt").read_text().split())
    return int(width), int(height), [[fx, 0, cx], [0, fy, cy], [0, 0, 1]]


def read_ours(folder):
    path = folder / "ours.json"
    return json.loads(path.read_text()) if path.exists() else None


class Scene:
    """The dumped Gaussians as parameters on the GPU."""

    def __init__(self, folder, torch, numpy):
        def load(name, *shape):
            values = numpy.fromfile(folder / f"{name}.f32", dtype=numpy.float32).reshape(-1, *shape)
            return torch.from_numpy(values).cuda()

        sh = load("sh", 16, 3)
        self.parameters = {
            "means": load("means", 3),
            "log_scales": load("log_scales", 3),
            "quats": load("quats", 4),
            "opacity_logits": load("opacity_logits").reshape(-1),
            "sh0": sh[:, :1].contiguous(),
            "sh_rest": sh[:, 1:].contiguous(),
        }
        for tensor in self.parameters.values():
            tensor.requires_grad_()
        self.width, self.height, intrinsics = read_camera(folder)
        self.view = torch.eye(4, device="cuda")[None]
        self.intrinsics = torch.tensor([intrinsics], device="cuda", dtype=torch.float32)

    def render(self, gsplat, torch):
        p = self.parameters
        image, _, _ = gsplat.rasterization(
            p["means"], p["quats"], p["log_scales"].exp(), p["opacity_logits"].sigmoid(), torch.cat([p["sh0"], p["sh_rest"]], 1),
            self.view, self.intrinsics, self.width, self.height, sh_degree=3,
        )
        return image


def ssim_loss(torch):
    """1 - SSIM: of the package fused_ssim, which gsplat's trainer uses, or by torch's convolutions."""
    try:
        from fused_ssim import fused_ssim

        return lambda a, b: 1 - fused_ssim(a, b, padding="valid")
    except ImportError:
        pass
    steps = torch.arange(11, device="cuda", dtype=torch.float32) - 5
    window = torch.exp(-(steps**2) / (2 * 1.5**2))
    window = (window / window.sum())[None, None, :].repeat(3, 1, 1)

    def blur(x):
        x = torch.nn.functional.conv2d(x, window[:, :, None, :], groups=3)
        return torch.nn.functional.conv2d(x, window[:, :, :, None], groups=3)

    def loss(a, b):
        mean_a, mean_b = blur(a), blur(b)
        var_a, var_b = blur(a * a) - mean_a**2, blur(b * b) - mean_b**2
        both = blur(a * b) - mean_a * mean_b
        top = (2 * mean_a * mean_b + 1e-4) * (2 * both + 9e-4)
        return 1 - (top / ((mean_a**2 + mean_b**2 + 1e-4) * (var_a + var_b + 9e-4))).mean()

    return loss


def median_of(torch, marks_of_pass):
    """Median milliseconds between neighbouring marks of PASSES calls of marks_of_pass(), which returns CUDA events."""
    times = []
    for step in range(WARM_UP + PASSES):
        marks = marks_of_pass()
        torch.cuda.synchronize()
        if step >= WARM_UP:
            times.append([a.elapsed_time(b) for a, b in zip(marks, marks[1:])])
    return [statistics.median(column) for column in zip(*times)]


def measure(folder, gsplat, torch, numpy):
    scene = Scene(folder, torch, numpy)

    def mark():
        event = torch.cuda.Event(enable_timing=True)
        event.record()
        return event

    def rasterise():
        begin = mark()
        image = scene.render(gsplat, torch)
        drawn = mark()
        image.sum().backward()
        return [begin, drawn, mark()]

    forward, backward = median_of(torch, rasterise)
    with torch.no_grad():
        target = torch.rand_like(scene.render(gsplat, torch))
    adams = [torch.optim.Adam([tensor], lr=RATES[name], eps=1e-15, fused=True) for name, tensor in scene.parameters.items()]
    dissimilarity = ssim_loss(torch)
    inject_noise = getattr(getattr(gsplat.strategy, "ops", None), "inject_noise_to_position", None)

    def iterate():
        begin = mark()
        image = scene.render(gsplat, torch)
        planes = image.permute(0, 3, 1, 2), target.permute(0, 3, 1, 2)
        (0.8 * (image - target).abs().mean() + 0.2 * dissimilarity(*planes)).backward()
        for adam in adams:
            adam.step()
            adam.zero_grad(set_to_none=True)
        if inject_noise is not None:
            p = scene.parameters
            names = {"means": p["means"], "scales": p["log_scales"], "quats": p["quats"], "opacities": p["opacity_logits"]}
            inject_noise(params=names, optimizers={}, state={}, scaler=RATES["means"] * 5e5)
        return [begin, mark()]

    (iteration,) = median_of(torch, iterate)
    return {"forward": forward, "backward": backward, "iteration": iteration}


def main():
    folder = Path(sys.argv[1])
    if len(sys.argv) > 2:
        sys.path.insert(0, sys.argv[2])
    try:
        import gsplat
        import gsplat.strategy
        import numpy
        import torch
    except ImportError as error:
        print(f"gsplat: skipped, {error}")
        return 0
    if not torch.cuda.is_available():
        print("gsplat: skipped, PyTorch finds no GPU")
        return 0
    print(line(getattr(gsplat, "__version__", "(source)"), measure(folder, gsplat, torch, numpy), read_ours(folder)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
