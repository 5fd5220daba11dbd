#!/usr/bin/env python3
"""scripts/convert_weights.py reads what torch.save writes, in both formats, and refuses everything else."""

import collections
import contextlib
import io
import json
import os
import pickle
import shutil
import struct
import subprocess
import sys
import tempfile
import types
import unittest
import zipfile
from pathlib import Path

from harness import ROOT, main

SCRIPT = ROOT / "scripts/convert_weights.py"
sys.path.insert(0, str(SCRIPT.parent))
import convert_weights  # noqa: E402

# Stand-ins for PyTorch's own, under whose names pickle writes them down.
torch, torch_utils = types.ModuleType("torch"), types.ModuleType("torch._utils")
sys.modules.update({"torch": torch, "torch._utils": torch_utils})


def stand_in(module, name, make):
    thing = make(name)
    thing.__module__, thing.__qualname__ = module.__name__, name
    setattr(module, name, thing)
    return thing


FORMATS = {"FloatStorage": "f", "HalfStorage": "e", "DoubleStorage": "d", "LongStorage": "q", "BFloat16Storage": "H"}
STORAGES = {name: stand_in(torch, name, lambda name: type(name, (), {})) for name in FORMATS}


def pickled_function(name):
    def function(*_):
        raise AssertionError("only its name is used")

    function.__name__ = name
    return function


REBUILD = stand_in(torch_utils, "_rebuild_tensor_v2", pickled_function)
REBUILD_OLD = stand_in(torch_utils, "_rebuild_tensor", pickled_function)
REBUILD_PARAMETER = stand_in(torch_utils, "_rebuild_parameter", pickled_function)


class Numbers:
    """A storage."""

    count = 0

    def __init__(self, values, kind="FloatStorage"):
        Numbers.count += 1
        self.key, self.values, self.kind = str(Numbers.count), values, kind

    def bytes(self):
        return struct.pack(f"<{len(self.values)}{FORMATS[self.kind]}", *self.values)


class FakeTensor:
    def __init__(self, storage, shape, strides=None, offset=0):
        if strides is None:
            strides = [1] * len(shape)
            for i in reversed(range(len(shape) - 1)):
                strides[i] = strides[i + 1] * shape[i + 1]
        self.parts = (storage, offset, tuple(shape), tuple(strides))

    def __reduce__(self):
        return REBUILD, (*self.parts, False, collections.OrderedDict())


class OldTensor(FakeTensor):
    """As PyTorch before 0.4 wrote it, for example VGG16 of torchvision."""

    def __reduce__(self):
        return REBUILD_OLD, self.parts


class Parameter:
    def __init__(self, tensor):
        self.tensor = tensor

    def __reduce__(self):
        return REBUILD_PARAMETER, (self.tensor, True, collections.OrderedDict())


def tensor(values, shape, kind="FloatStorage"):
    return FakeTensor(Numbers(values, kind), shape)


def state_dict(**tensors):
    state = collections.OrderedDict(tensors)
    state._metadata = collections.OrderedDict([("", {"version": 1})])  # written with BUILD, as PyTorch does
    return state


def pickle_of(root, legacy=False, protocol=2):
    """The pickle, and the storages it refers to."""
    found, stream = {}, io.BytesIO()

    class Pickler(pickle.Pickler):
        def persistent_id(self, thing):
            if not isinstance(thing, Numbers):
                return None
            found[thing.key] = thing
            view = (None,) if legacy else ()
            return ("storage", STORAGES[thing.kind], thing.key, "cpu", len(thing.values), *view)

    Pickler(stream, protocol).dump(root)
    return stream.getvalue(), found


def zipped(root, name="archive", compression=zipfile.ZIP_STORED, **parts):
    text, found = pickle_of(root)
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", compression) as archive:
        archive.writestr(f"{name}/data.pkl", text)
        for key, storage in found.items():
            archive.writestr(f"{name}/data/{key}", storage.bytes())
        for part, content in {"version": b"3\n", **parts}.items():
            archive.writestr(f"{name}/{part}", content)
    return stream.getvalue()


def legacy(root):
    text, found = pickle_of(root, legacy=True)
    system = {"protocol_version": 1001, "little_endian": True, "type_sizes": {"short": 2, "int": 4, "long": 4}}
    out = b"".join(pickle.dumps(part, 2) for part in (0x1950A86A20F9469CFC6C, 1001, system))
    out += text + pickle.dumps(sorted(found), 2)
    return out + b"".join(struct.pack("<q", len(found[key].values)) + found[key].bytes() for key in sorted(found))


def read_safetensors(path):
    """{name: (dtype, shape, values)} and the metadata."""
    data = path.read_bytes()
    (size,) = struct.unpack("<Q", data[:8])
    header = json.loads(data[8 : 8 + size])
    metadata = header.pop("__metadata__")
    codes = {"F32": "f", "F16": "e", "F64": "d", "I64": "q", "BF16": "H"}
    tensors = {}
    for name, entry in header.items():
        begin, end = (8 + size + offset for offset in entry["data_offsets"])
        code = codes[entry["dtype"]]
        values = struct.unpack(f"<{(end - begin) // struct.calcsize(code)}{code}", data[begin:end])
        tensors[name] = (entry["dtype"], entry["shape"], list(values))
    return tensors, metadata


class Convert(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.dir = Path(tempfile.mkdtemp(prefix="oraclegs_convert_"))
        cls.addClassCleanup(shutil.rmtree, cls.dir, ignore_errors=True)

    def run_script(self, *files, arguments=()):
        """What the script said, and its exit code; each file is its bytes. Runs inside the test: there are hundreds."""
        self.out = self.dir / "out/model.safetensors"
        shutil.rmtree(self.out.parent, ignore_errors=True)
        paths = [self.dir / f"{i}.pth" for i in range(len(files))]
        for path, content in zip(paths, files):
            path.write_bytes(content)
        words = [str(part) for part in ["--out", self.out, *arguments, *paths]]
        with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(io.StringIO()) as err:
            code = convert_weights.main(words)
        return subprocess.CompletedProcess(words, code, out.getvalue(), err.getvalue())

    def convert(self, *files, arguments=()):
        done = self.run_script(*files, arguments=arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual([path.name for path in self.out.parent.iterdir()], ["model.safetensors"])
        return read_safetensors(self.out)[0]

    def refused(self, content, *words, arguments=()):
        done = self.run_script(content, arguments=arguments)
        self.assertEqual(done.returncode, 3, done.stdout + done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertTrue(done.stderr.startswith(f"convert_weights.py: error: {self.dir / '0.pth'}: "), done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)
        self.assertFalse(self.out.exists())

    def test_both_formats_and_every_kind_of_number(self):
        root = state_dict(a=tensor([1, 2, 3, 4, 5, 6], (2, 3)), h=tensor([0.5, -2], (2,), "HalfStorage"),
                          d=tensor([0.1], (), "DoubleStorage"), i=tensor([-7], (1,), "LongStorage"),
                          b=tensor([0x3F80], (1, 1), "BFloat16Storage"), none=tensor([], (0, 4)),
                          p=Parameter(tensor([8], (1,))), o=OldTensor(Numbers([9, 10]), (2,)))  # fmt: skip
        expected = {"a": ("F32", [2, 3], [1, 2, 3, 4, 5, 6]), "h": ("F16", [2], [0.5, -2]), "d": ("F64", [], [0.1]),
                    "i": ("I64", [1], [-7]), "b": ("BF16", [1, 1], [0x3F80]), "none": ("F32", [0, 4], []),
                    "p": ("F32", [1], [8]), "o": ("F32", [2], [9, 10])}  # fmt: skip
        for content in (zipped(root), zipped(root, name="model", byteorder=b"little"), legacy(root)):
            self.assertEqual(self.convert(content), expected)
        self.assertEqual(read_safetensors(self.out)[1], {"source": "0.pth"})
        self.assertEqual(self.convert(self.out.read_bytes()), expected)  # safetensors are read, too

    def test_views_become_tensors_of_their_own(self):
        row = Numbers(list(range(12)))
        root = state_dict(part=FakeTensor(row, (2, 2), offset=3), turned=FakeTensor(row, (4, 3), (1, 4)),
                          spaced=FakeTensor(row, (2, 2, 2), (6, 3, 2)), same=FakeTensor(row, (3, 2), (1, 0)))  # fmt: skip
        for content in (zipped(root), legacy(root)):
            found = self.convert(content)
            self.assertEqual(found["part"][2], [3, 4, 5, 6])
            self.assertEqual(found["turned"][2], [0, 4, 8, 1, 5, 9, 2, 6, 10, 3, 7, 11])
            self.assertEqual(found["spaced"][2], [0, 2, 3, 5, 6, 8, 9, 11])
            self.assertEqual(found["same"][2], [0, 0, 1, 1, 2, 2])

    def test_state_dicts_are_found_in_what_training_programs_write(self):
        state = state_dict(**{"module.a": tensor([1], (1,)), "module.b.c": tensor([2], (1,))})
        for root in (state, {"state_dict": state, "epoch": 3, "name": "x"}, {"model": {"state_dict": state}},
                     {"net": state, "lr": 0.1, "flags": [True, None, (1, 2, 3, 4)]}):  # fmt: skip
            self.assertEqual(set(self.convert(zipped(root))), {"a", "b.c"})
        ema = {"ema": {"x": tensor([1], (1,))}, "other": 5}
        self.refused(zipped(ema), "holds no state dict, but: ema, other; choose one with --key")
        self.assertEqual(set(self.convert(zipped(ema), arguments=["--key", "ema"])), {"x"})
        self.refused(zipped(ema), "holds nothing under --key other", arguments=["--key", "other"])
        self.refused(zipped([1, 2]), "holds no state dict, but: list")

    def test_lpips_is_made_of_two_files(self):
        features = state_dict(**{"features.0.weight": tensor([1], (1,)), "classifier.6.bias": tensor([1], (1,))})
        for names in ("lin{}.model.1.weight", "{}.1.weight"):
            weights = state_dict(**{names.format(i): tensor([i], (1, 1, 1, 1)) for i in range(5)})
            found = self.convert(legacy(features), legacy(weights), arguments=["--model", "lpips-vgg"])
            self.assertEqual(set(found), {"features.0.weight"} | {f"lin{i}.model.1.weight" for i in range(5)})
            self.assertEqual(found["lin3.model.1.weight"], ("F32", [1, 1, 1, 1], [3]))
        self.assertEqual(read_safetensors(self.out)[1], {"source": "0.pth + 1.pth", "model": "lpips-vgg"})
        twice = self.run_script(legacy(features), legacy(features))
        self.assertIn("1.pth: holds 'features.0.weight', which another of the files holds, too", twice.stderr)

    def test_the_part_of_clip_that_sees(self):
        root = state_dict(**{"visual.proj": tensor([1, 2], (1, 2)), "transformer.x": tensor([1], (1,))})
        self.assertEqual(set(self.convert(zipped(root), arguments=["--model", "openclip-vith14"])), {"visual.proj"})
        self.refused(zipped(state_dict(x=tensor([1], (1,)))), "holds no tensor of openclip-vith14",
                     arguments=["--model", "openclip-vith14"])  # fmt: skip

    def test_old_names_of_the_autoencoder(self):
        at = "decoder.mid_block.attentions.0."
        names = {"query": "to_q", "key": "to_k", "value": "to_v", "proj_attn": "to_out.0", "group_norm": "group_norm"}
        for shape in ((2, 2), (2, 2, 1, 1)):
            old = {f"{at}{name}.weight": tensor([1, 2, 3, 4], shape) for name in list(names)[:4]}
            old[at + "group_norm.weight"] = tensor([1, 2], (2,))
            old["quant_conv.weight"] = tensor([1], (1, 1, 1, 1))
            found = self.convert(zipped(state_dict(**old)), arguments=["--model", "sd21-vae"])
            self.assertEqual(set(found), {f"{at}{name}.weight" for name in names.values()} | {"quant_conv.weight"})
            self.assertEqual(found[at + "to_q.weight"], ("F32", [2, 2], [1, 2, 3, 4]))
            self.assertEqual(found["quant_conv.weight"][1], [1, 1, 1, 1])

    def test_a_pickle_that_would_run_something_is_refused(self):
        witness = self.dir / "was_run"

        class Evil:
            def __init__(self, call, *arguments):
                self.parts = (call, arguments)

            def __reduce__(self):
                return self.parts

        command = f"touch {witness}"
        for evil in (Evil(os.system, command), Evil(eval, f"open({str(witness)!r}, 'w')"), Evil(getattr, "", "join"),
                     Evil(subprocess.Popen, command), Evil(io.open, str(witness), "w")):  # fmt: skip
            root = state_dict(a=tensor([1], (1,)), b=evil)
            self.refused(zipped(root), "which is no part of a state dict; refused")
            self.refused(legacy(root), "which is no part of a state dict; refused")
        for content in (b"cos\nsystem\n(S'touch x'\ntR.", b"(S'touch x'\nios\nsystem\n.", b"\x80\x02\x82\x01."):
            self.refused(self.with_pickle(content), "refused")
        self.refused(self.with_pickle(pickle.dumps(Path("x"), 4)), "refused")
        # Names that are known, but used for what they are not.
        storage = b"\x80\x02ctorch\nFloatStorage\n"
        self.refused(self.with_pickle(storage + b")R."), "calls what cannot be called")
        self.refused(self.with_pickle(b"\x80\x02K\x01)R."), "calls what cannot be called")
        self.refused(self.with_pickle(b"\x80\x02X\x01\x00\x00\x00xQ."), "refers to something that is no storage")
        self.refused(self.with_pickle(b"\x80\x02}(K\x01\x85K\x01\x86K\x02u."), "a key that is neither text nor number")
        self.assertFalse(witness.exists())

    def with_pickle(self, text):
        stream = io.BytesIO()
        with zipfile.ZipFile(stream, "w") as archive:
            archive.writestr("a/data.pkl", text)
        return stream.getvalue()

    def test_tensors_that_reach_beyond_their_numbers(self):
        def one(shape, strides, offset=0, count=4):
            return zipped(state_dict(t=FakeTensor(Numbers([0] * count), shape, strides, offset)))

        self.convert(one((2, 2), (2, 1)))
        for content in (one((5,), (1,)), one((2, 2), (2, 1), offset=1), one((2,), (4,)), one((3, 2), (0, 1)),
                        one((1 << 40,), (0,))):  # fmt: skip
            self.refused(content, "reaches beyond its numbers")
        for content in (one((-1,), (1,)), one((2,), (1, 1)), one((1,) * 40, (1,) * 40), one((2.0,), (1,)),
                        one((True,), (1,)), one((1,), (1,), offset=-1)):  # fmt: skip
            self.refused(content, "is malformed")

    def test_damaged_files(self):
        root = state_dict(a=tensor([1, 2, 3], (3,)))
        for content in (zipped(root), legacy(root)):
            for size in range(0, len(content), 7):
                self.refused(content[:size], "0.pth: ")
        self.refused(zipped(root, compression=zipfile.ZIP_DEFLATED), "is compressed or damaged")
        self.refused(zipped(root, byteorder=b"big"), "big-endian")
        self.refused(b"<html>not found</html>", "is neither a checkpoint of PyTorch nor a safetensors file")
        self.refused(struct.pack("<Q", 1 << 40) + b"{" + b" " * 64, "is cut off, or no safetensors file")
        for header in (b'{"a":1}', b"{", b'{"a":{"dtype":"F32","shape":[9],"data_offsets":[0,36]}}'):
            self.refused(struct.pack("<Q", len(header)) + header + b" " * 16, "0.pth: ")
        stream = io.BytesIO()
        with zipfile.ZipFile(stream, "w") as archive:
            archive.writestr("photos/1.jpg", b"x" * 100)
        self.refused(stream.getvalue(), "no checkpoint of PyTorch (it has no data.pkl)")
        _, found = pickle_of(root)
        name = "archive/data/" + next(iter(found))
        lacking = zipped(root).replace(name.encode(), name[:-1].encode() + b"x")
        self.refused(lacking, "lacks its part 'data/")

    def test_as_a_program(self):
        done = subprocess.run([sys.executable, SCRIPT, "--out", self.dir / "o", self.dir / "none.pth"],
                              capture_output=True, text=True, check=False)  # fmt: skip
        self.assertEqual((done.returncode, done.stderr),
                         (3, f"convert_weights.py: error: {self.dir}/none.pth: No such file or directory\n"))  # fmt: skip
        done = subprocess.run([sys.executable, SCRIPT, "--model", "vgt", "--out", "o", "x"], capture_output=True,
                              text=True, check=False)  # fmt: skip
        self.assertEqual(done.returncode, 2)
        self.assertIn("vggt-commercial", done.stderr)

    def test_files_that_cannot_be_written(self):
        good = self.dir / "good.pth"
        good.write_bytes(zipped(state_dict(a=tensor([1], (1,)))))
        done = subprocess.run([sys.executable, SCRIPT, "--out", good / "in/o", good], capture_output=True, text=True,
                              check=False)  # fmt: skip
        self.assertEqual(done.returncode, 3)
        self.assertIn("cannot write: ", done.stderr)


if __name__ == "__main__":
    main()
