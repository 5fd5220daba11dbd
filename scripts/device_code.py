#!/usr/bin/env python3
"""What nvcc makes of the device code: registers, shared memory, stack and spills of each kernel, and the instructions of a
step of the blend loops. Needs nvcc, no GPU.

    scripts/device_code.py             prints the table
    scripts/device_code.py --check     and fails where a bound is passed: spills, or a loop that has grown

A step is one Gaussian at a warp's pixels, counted in PTX as the loop's instructions over its ex2, and in the backward
blend a sixteenth of what is done once for sixteen Gaussians; moves and changes of sign are left out, for the assembler
makes operands of them.
"""

import concurrent.futures
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
STEP_BOUNDS = {"BlendBackwardKernel": 65, "BlendForwardKernel": 45}  # instructions
BATCH = {"BlendBackwardKernel": 16}  # Gaussians whose terms are summed at once, kBatch of blend_backward.cu


def nvcc():
    for place in ["nvcc", "/usr/local/cuda/bin/nvcc"]:
        if shutil.which(place):
            return shutil.which(place)
    sys.exit("scripts/device_code.py: nvcc was not found; install the CUDA toolkit")


def compiled(source, folder):
    """(PTX, what ptxas says) of a .cu file."""
    ptx = folder / (source.stem + ".ptx")
    config = folder / "oraclegs" / "core"
    flags = ["-std=c++20", "-O3", "-arch=sm_90", "--expt-relaxed-constexpr", f"-I{ROOT}/src", f"-I{folder}"]
    config.mkdir(parents=True, exist_ok=True)
    (config / "config.h").write_text("#define ORACLEGS_CUDA 1\n")
    subprocess.run([nvcc(), *flags, "-ptx", "-o", ptx, source], check=True)
    said = subprocess.run(
        [nvcc(), *flags, "-cubin", "-Xptxas", "-v", "-o", folder / (source.stem + ".cubin"), source],
        check=True, capture_output=True, text=True)
    return ptx.read_text(), said.stderr


def short(name):
    """The kernel's own name out of a mangled one."""
    words = []
    at = 0
    while match := re.compile(r"(\d+)").search(name, at):
        length = int(match[1])
        word = name[match.end():match.end() + length]
        at = match.end() + (length if len(word) == length else 0)
        words.append(word)
    kernels = [word for word in words if re.fullmatch(r"[A-Z]\w*", word)]
    return kernels[0] if kernels else name


def steps(ptx):
    """{kernel: instructions of a step} of the kernels that have a loop around ex2."""
    found = {}
    for entry in re.split(r"\.entry ", ptx)[1:]:
        instructions, labels = [], {}
        for line in map(str.strip, entry.splitlines()):
            if match := re.match(r"(\$L__BB\w+):", line):
                labels[match[1]] = len(instructions)
            elif re.match(r"(@!?%p\d+\s+)?[a-z][\w.]*(\s.*)?;$", line):
                instructions.append(line)
        loops = []  # (instructions that count, exponentials), the innermost first
        for i, line in enumerate(instructions):
            match = re.search(r"\bbra(?:\.uni)?\s+(\$L__BB\w+)", line)
            if match and labels.get(match[1], i + 1) <= i:
                loop = instructions[labels[match[1]]:i + 1]
                exponentials = sum("ex2" in one for one in loop)
                if exponentials:
                    loops.append((sum(not re.match(r"(mov|neg)\.", one) for one in loop), exponentials))
        if loops:
            name, loops = short(entry.split("(")[0]), sorted(loops)
            of_step = loops[0][0] / loops[0][1]
            if name in BATCH:
                of_step += (loops[1][0] - loops[0][0]) / BATCH[name]
            found[name] = max(found.get(name, 0), of_step)  # of several instances the worst
    return found


def resources(said):
    """[(kernel, registers, shared bytes, stack bytes, spilled bytes)]"""
    rows = []
    for part in said.split("Compiling entry function '")[1:]:
        def number(pattern):
            match = re.search(pattern, part)
            return int(match[1]) if match else 0
        rows.append((short(part.split("'")[0]), number(r"Used (\d+) registers"), number(r"(\d+) bytes smem"),
                     number(r"(\d+) bytes stack frame"),
                     number(r"(\d+) bytes spill stores") + number(r"(\d+) bytes spill loads")))
    return rows


def main():
    check = sys.argv[1:] == ["--check"]
    if sys.argv[1:] and not check:
        sys.exit(__doc__)
    sources = sorted((ROOT / "src" / "oraclegs").glob("*/cuda/*.cu"))
    wrong = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            results = list(pool.map(lambda source: compiled(source, folder), sources))
    print(f"{'file':22} {'kernel':32} {'registers':>9} {'shared':>7} {'stack':>6} {'spills':>6} {'step':>5}")
    seen = set()
    for source, (ptx, said) in zip(sources, results):
        of_step = steps(ptx)
        for kernel, registers, shared, stack, spills in resources(said):
            step = of_step.get(kernel, 0) if kernel in STEP_BOUNDS else 0
            if source.name == "sort_scan.cu":  # the toolkit's own
                continue
            print(f"{source.name:22} {kernel:32} {registers:9} {shared:7} {stack:6} {spills:6} {f'{step:.0f}' if step else '':>5}")
            if spills:
                wrong.append(f"{kernel} spills {spills} bytes")
            if step:
                seen.add(kernel)
                if step > STEP_BOUNDS[kernel]:
                    wrong.append(f"a step of {kernel} has {step:.0f} instructions, more than {STEP_BOUNDS[kernel]}")
    wrong += [f"no loop was found in {kernel}" for kernel in STEP_BOUNDS.keys() - seen]
    if check and wrong:
        sys.exit("scripts/device_code.py: " + "; ".join(wrong))


if __name__ == "__main__":
    main()
