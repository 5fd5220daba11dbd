#!/usr/bin/env python3
"""Times gsplat on the scene that gpu_bench --dump wrote, beside gpu_bench's own figures (--json).

usage: bench/gsplat_bench.py FOLDER OURS.json [PATH]     PATH: gsplat's source, where it is not installed

Two measures: the rasterizer alone (forward, backward), and a training iteration as gsplat's own trainer makes it with MCMC:
rasterize (packed=False), L1 + SSIM, the regularizers of opacity and scale, backward, one fused Adam for each group of
parameters, noise. Prints one line, which names the SSIM that was used. Exit code 1 where gsplat cannot be timed.
"""

import json
import statistics
import sys
from pathlib import Path

WARM_UP, PASSES = 5, 30
FUSED, CONVOLUTIONS = "fused_ssim", "torch's convolutions"
REGULARIZER = 0.01  # weight of the mean opacity and of the mean scale
# A thousandth of gsplat's rates, so that every iteration works on the same scene.
RATES = {"means": 1.6e-9, "log_scales": 5e-6, "quats": 1e-6, "opacity_logits": 5e-5, "sh0": 2.5e-6, "sh_rest": 1.25e-7}


def line(version, theirs, ours, ssim):
    """The result. theirs: median milliseconds of forward, backward, iteration; ours: what gpu_bench wrote, or {}; ssim: what
    computed it. Iterations are compared only where that is the fused kernel which gsplat's trainer uses."""
    text = f"gsplat {version}: forward {theirs['forward']:.3f} ms, backward {theirs['backward']:.3f} ms, iteration {theirs['iteration']:.3f} ms (SSIM of {ssim})"
    for name in ("forward", "iteration"):
        mine = ours.get(f"{name}_ms", 0)
        if mine > 0:
            fair = name == "forward" or ssim == FUSED
            factor = f"{theirs[name] / mine:.2f} times as fast" if fair else "not comparable without fused_ssim"
            text += f"; our {name} {mine:.3f} ms, {factor}"
    return text


def read_camera(folder):
    """Width, height, intrinsics [3][3], camera from world [4][4]."""
    first, *rows = (folder / "camera.txt").read_text().splitlines()
    width, height, fx, fy, cx, cy = (float(word) for word in first.split())
    pose = [[float(word) for word in row.split()] for row in rows]
    return int(width), int(height), [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], pose


def read_ours(path):
    return json.loads(path.read_text()) if path.exists() else {}


def missing_submodule(source):
    """What the source lacks to be compiled, or None."""
    glm = source / "gsplat/cuda/csrc/third_party/glm"
    if (source / "gsplat/cuda/csrc").is_dir() and not (glm / "glm").is_dir():
        return f"{glm} is empty: clone gsplat with --recursive"
    return None


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
        self.width, self.height, intrinsics, pose = read_camera(folder)
        self.view = torch.tensor([pose], device="cuda", dtype=torch.float32)
        self.intrinsics = torch.tensor([intrinsics], device="cuda", dtype=torch.float32)

    def render(self, gsplat, torch):
        p = self.parameters
        image, _, _ = gsplat.rasterization(
            p["means"], p["quats"], p["log_scales"].exp(), p["opacity_logits"].sigmoid(), torch.cat([p["sh0"], p["sh_rest"]], 1),
            self.view, self.intrinsics, self.width, self.height, sh_degree=3, packed=False,
        )
        return image


def ssim_loss(torch):
    """1 - SSIM, of the package fused_ssim, which gsplat's trainer uses, or by torch's convolutions; and which of them it is."""
    try:
        from fused_ssim import fused_ssim

        return lambda a, b: 1 - fused_ssim(a, b, padding="valid"), FUSED
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

    return loss, CONVOLUTIONS


def median_of(torch, marks_of_pass):
    """Median milliseconds between neighboring marks of PASSES calls of marks_of_pass(), which returns CUDA events."""
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

    def rasterize():
        begin = mark()
        image = scene.render(gsplat, torch)
        drawn = mark()
        image.sum().backward()
        return [begin, drawn, mark()]

    forward, backward = median_of(torch, rasterize)
    with torch.no_grad():
        target = torch.rand_like(scene.render(gsplat, torch))
    adams = [torch.optim.Adam([tensor], lr=RATES[name], eps=1e-15, fused=True) for name, tensor in scene.parameters.items()]
    dissimilarity, ssim = ssim_loss(torch)
    inject_noise = getattr(getattr(gsplat.strategy, "ops", None), "inject_noise_to_position", None)

    def iterate():
        begin = mark()
        image = scene.render(gsplat, torch)
        planes = image.permute(0, 3, 1, 2), target.permute(0, 3, 1, 2)
        loss = 0.8 * (image - target).abs().mean() + 0.2 * dissimilarity(*planes)
        loss = loss + REGULARIZER * scene.parameters["opacity_logits"].sigmoid().mean()
        loss = loss + REGULARIZER * scene.parameters["log_scales"].exp().mean()
        loss.backward()
        for adam in adams:
            adam.step()
            adam.zero_grad(set_to_none=True)
        if inject_noise is not None:
            p = scene.parameters
            names = {"means": p["means"], "scales": p["log_scales"], "quats": p["quats"], "opacities": p["opacity_logits"]}
            inject_noise(params=names, optimizers={}, state={}, scaler=RATES["means"] * 5e5)
        return [begin, mark()]

    (iteration,) = median_of(torch, iterate)
    return {"forward": forward, "backward": backward, "iteration": iteration}, ssim


def main():
    folder, ours = Path(sys.argv[1]), Path(sys.argv[2])
    if len(sys.argv) > 3:
        source = Path(sys.argv[3])
        lacks = missing_submodule(source)
        if lacks:
            print(f"gsplat: not timed, {lacks}")
            return 1
        sys.path.insert(0, str(source))
    try:
        import gsplat
        import gsplat.strategy
        import numpy
        import torch
    except ImportError as error:
        print(f"gsplat: not timed, {error}")
        return 1
    if not torch.cuda.is_available():
        print("gsplat: not timed, PyTorch finds no GPU")
        return 1
    theirs, ssim = measure(folder, gsplat, torch, numpy)
    print(line(getattr(gsplat, "__version__", "(source)"), theirs, read_ours(ours), ssim))
    return 0


if __name__ == "__main__":
    sys.exit(main())
