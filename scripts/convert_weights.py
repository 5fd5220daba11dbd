#!/usr/bin/env python3
"""Turns published checkpoints of PyTorch (.pth, .pt, .bin) or safetensors into one safetensors file for OracleGS.

usage: scripts/convert_weights.py [--model NAME] [--key KEY] --out OUT.safetensors FILE...

Needs neither PyTorch nor NumPy, and runs nothing of what a file says (torch_checkpoint.py). Several files become one.
--model chooses which tensors are kept and how they are renamed, see RULES.
"""

import argparse
import collections
import json
import math
import mmap
import os
import re
import struct
import sys
import zipfile
from pathlib import Path

sys.dont_write_bytecode = True  # no folder of compiled files beside the script
from torch_checkpoint import BYTES, BadFile, Storage, Tensor, contiguous, read_legacy, read_zip, whole  # noqa: E402

ELEMENT = {1: "B", 2: "H", 4: "I", 8: "Q"}  # to move elements of this width
PIECE = 1 << 24  # bytes written at once
MAX_HEADER = 100_000_000

# Where training programs put the state dict, and what they put before its names.
WRAPPERS = ["state_dict", "model_state_dict", "model", "net", "network", "params", "weights", "module"]
PREFIXES = ["module.", "_orig_mod.", "model."]

Rule = collections.namedtuple("Rule", "keep drop rename flatten", defaults=[(), (), (), ()])
LPIPS = Rule(drop=["classifier."], rename=[(r"^([0-4])\.1\.weight$", r"lin\1.model.1.weight")])
ATTENTION = r"(\.attentions\.\d+)\."
RULES = {
    "depth-anything-v2-small": Rule(),
    "depth-anything-v2-base": Rule(),
    "depth-anything-v2-large": Rule(),
    "vggt": Rule(),
    "vggt-commercial": Rule(),
    "lpips-vgg": LPIPS,
    "lpips-alex": LPIPS,
    "seva": Rule(),
    # Older files name the attention otherwise and store its matrices as 1x1 convolutions.
    "sd21-vae": Rule(rename=[(ATTENTION + r"query\.", r"\1.to_q."), (ATTENTION + r"key\.", r"\1.to_k."),
                             (ATTENTION + r"value\.", r"\1.to_v."), (ATTENTION + r"proj_attn\.", r"\1.to_out.0.")],
                     flatten=[r"\.attentions\.\d+\.to_(q|k|v|out\.0)\.weight$"]),  # fmt: skip
    "openclip-vith14": Rule(keep=["visual."]),
}


def read_safetensors(data):
    (size,) = struct.unpack("<Q", data[:8])
    if size > min(MAX_HEADER, len(data) - 8):
        raise BadFile("is cut off, or no safetensors file; get it again")
    try:
        header = json.loads(data[8 : 8 + size])
        header.pop("__metadata__", None)
        state = {}
        for name, entry in header.items():
            begin, end = entry["data_offsets"]
            shape, dtype = entry["shape"], entry["dtype"]
            storage = Storage(dtype, math.prod(shape))
            storage.begin = 8 + size + begin
            fits = whole(begin, end, *shape) and end - begin == storage.numel * BYTES[dtype]
            if not fits or 8 + size + end > len(data):
                raise BadFile(f"tensor {name!r:.120} lies outside the file; get it again")
            state[name] = contiguous(storage, shape)
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise BadFile("its header is damaged; get the file again") from error
    return state


def find_state_dict(root, key):
    """The dict of tensors in what a checkpoint holds."""
    if key:
        if not isinstance(root, dict) or not isinstance(root.get(key), dict):
            raise BadFile(f"holds nothing under --key {key}")
        root = root[key]
    for _ in range(4):
        inner = next((root[w] for w in WRAPPERS if isinstance(root, dict) and isinstance(root.get(w), dict)), None)
        if inner is None:
            break
        root = inner
    if not isinstance(root, dict) or not any(isinstance(value, Tensor) for value in root.values()):
        names = ", ".join(sorted(map(str, root))[:10]) if isinstance(root, dict) else type(root).__name__
        raise BadFile(f"holds no state dict, but: {names:.300}; choose one with --key")
    state = {name: value for name, value in root.items() if isinstance(value, Tensor) and isinstance(name, str)}
    for prefix in PREFIXES:
        if all(name.startswith(prefix) for name in state):
            state = {name[len(prefix) :]: value for name, value in state.items()}
    return state


def apply_rule(state, rule):
    out = {}
    for name, tensor in state.items():
        if rule.keep and not name.startswith(tuple(rule.keep)) or name.startswith(tuple(rule.drop)):
            continue
        for pattern, replacement in rule.rename:
            name = re.sub(pattern, replacement, name)
        if tensor.shape[2:] == (1, 1) and any(re.search(pattern, name) for pattern in rule.flatten):
            tensor = tensor._replace(shape=tensor.shape[:2], strides=tensor.strides[:2])
        if name in out:
            raise BadFile(f"two of its tensors become {name!r:.120}")
        out[name] = tensor
    return out


def bytes_of(tensor, data):
    """The numbers of a tensor in the order of its indices, in pieces."""
    width, begin = BYTES[tensor.storage.dtype], tensor.storage.begin
    if tensor.numel() == 0:
        return
    if tensor.is_contiguous():
        first = begin + tensor.offset * width
        end = first + tensor.numel() * width
        for piece in range(first, end, PIECE):
            yield data[piece : min(piece + PIECE, end)]
        return
    with memoryview(data) as view, view[begin : begin + tensor.storage.numel * width] as storage:
        with storage.cast(ELEMENT[width]) as elements:
            yield from rows_of(elements, tensor.offset, tensor.shape, tensor.strides)


def rows_of(elements, offset, shape, strides):
    if len(shape) > 1:
        for i in range(shape[0]):
            yield from rows_of(elements, offset + i * strides[0], shape[1:], strides[1:])
    elif strides[0] == 0:
        yield elements[offset : offset + 1].tobytes() * shape[0]
    else:
        yield elements[offset : offset + (shape[0] - 1) * strides[0] + 1 : strides[0]].tobytes()


def write_safetensors(path, tensors, metadata):
    """tensors: {name: (Tensor, data)}. The file appears when it is whole."""
    order = sorted(tensors, key=lambda name: (-BYTES[tensors[name][0].storage.dtype], name))
    header, position = {"__metadata__": metadata}, 0
    for name in order:
        tensor = tensors[name][0]
        end = position + tensor.numel() * BYTES[tensor.storage.dtype]
        header[name] = {"dtype": tensor.storage.dtype, "shape": list(tensor.shape), "data_offsets": [position, end]}
        position = end
    text = json.dumps(header, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 8)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".convert-{os.getpid()}.tmp")
    try:
        with open(temporary, "xb") as out:
            out.write(struct.pack("<Q", len(text)) + text)
            for name in order:
                for piece in bytes_of(*tensors[name]):
                    out.write(piece)
            out.flush()
            os.fsync(out.fileno())
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


def read_checkpoint(path, key):
    """{name: Tensor} and the mapped file."""
    with open(path, "rb") as stream:
        if os.fstat(stream.fileno()).st_size < 16:
            raise BadFile("is too short for a checkpoint; get it again")
        data = mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ)
        if data[:4] == b"PK\3\4":
            root = read_zip(data, stream)
        elif data[8:9] == b"{":
            root = read_safetensors(data)
        elif data[:1] == b"\x80":
            root = read_legacy(data)
        else:
            raise BadFile("is neither a checkpoint of PyTorch nor a safetensors file; name the published file")
    return find_state_dict(root, key), data


def convert(files, out, model=None, key=None):
    """Returns how many tensors were written."""
    tensors = {}
    for path in files:
        try:
            state, data = read_checkpoint(path, key)
            for name, tensor in apply_rule(state, RULES[model] if model else Rule()).items():
                if name in tensors:
                    raise BadFile(f"holds {name!r:.120}, which another of the files holds, too")
                tensors[name] = (tensor, data)
        except (OSError, zipfile.BadZipFile) as error:
            raise BadFile(f"{path}: {getattr(error, 'strerror', None) or 'is a damaged zip; get it again'}") from error
        except BadFile as error:
            raise BadFile(f"{path}: {error}") from error
    if not tensors:
        raise BadFile(f"{files[0]}: holds no tensor of {model}; is it the right file?")
    metadata = {"source": " + ".join(path.name for path in files)}
    if model:
        metadata["model"] = model
    try:
        write_safetensors(out, tensors, metadata)
    except OSError as error:
        raise BadFile(f"{out}: cannot write: {error.strerror}") from error
    return len(tensors)


def main(words=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE")
    parser.add_argument("--out", required=True, type=Path, metavar="OUT.safetensors")
    parser.add_argument("--model", choices=RULES, help="which network; without it all tensors keep their names")
    parser.add_argument("--key", help="where in the file the state dict is, if it is found nowhere usual")
    arguments = parser.parse_args(words)
    try:
        count = convert(arguments.files, arguments.out, arguments.model, arguments.key)
    except BadFile as error:
        line = str(error).replace("\n", " ")
        print(f"convert_weights.py: error: {line}", file=sys.stderr)
        return 3
    print(f"{arguments.out}: {count} tensors")
    return 0


if __name__ == "__main__":
    sys.exit(main())
