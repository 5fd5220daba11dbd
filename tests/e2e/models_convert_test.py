#!/usr/bin/env python3
"""`oraclegs models convert` reads what torch.save writes, in both formats, and refuses everything else."""

import io
import json
import os
import pickle
import shutil
import struct
import subprocess
import tempfile
import unittest
import zipfile
from pathlib import Path

from harness import command, main
from torch_files import (FakeTensor, Named, Numbers, OldTensor, Parameter, legacy, network, pickle_of, read_safetensors,
                         state_dict, tensor, zipped)  # fmt: skip

class Convert(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.dir = Path(tempfile.mkdtemp(prefix="oraclegs_convert_"))
        cls.addClassCleanup(shutil.rmtree, cls.dir, ignore_errors=True)

    def run_program(self, *files, arguments=()):
        """The finished process; each file is its bytes."""
        self.out = self.dir / "out/model.safetensors"
        shutil.rmtree(self.out.parent, ignore_errors=True)
        paths = [self.dir / f"{i}.pth" for i in range(len(files))]
        for path, content in zip(paths, files):
            path.write_bytes(content)
        words = command("models", "convert", "--out", self.out, *arguments, *paths)
        return subprocess.run(words, capture_output=True, text=True, timeout=100, check=False)

    def convert(self, *files, arguments=()):
        done = self.run_program(*files, arguments=arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual([path.name for path in self.out.parent.iterdir()], ["model.safetensors"])
        return read_safetensors(self.out)[0]

    def refused(self, content, *words, arguments=()):
        done = self.run_program(content, arguments=arguments)
        self.assertEqual(done.returncode, 3, done.stdout + done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertTrue(done.stderr.startswith(f"oraclegs: error: {self.dir / '0.pth'}: "), done.stderr)
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
                     {"net": state, "lr": 0.1, "flags": [True, None, (1, 2, 3, 4)]}, {"ema": state, "model": None},
                     {"params": {"rate": 0.1}, "ema": state, "path": Path("/x"), "keys": {(1, 2): 3}}):  # fmt: skip
            self.assertEqual(set(self.convert(zipped(root))), {"a", "b.c"})
        other = {"encoder": {"x": tensor([1], (1,))}, "other": 5}
        self.refused(zipped(other), "holds no state dict, but: encoder, other; choose one with --key")
        self.assertEqual(set(self.convert(zipped(other), arguments=["--key", "encoder"])), {"x"})
        self.refused(zipped(other), "holds nothing under --key decoder", arguments=["--key", "decoder"])
        self.refused(zipped([1, 2]), "holds no state dict, but: a list")

    def test_whole_networks(self):
        layer = network(parameters={"weight": Parameter(tensor([1, 2], (2,))), "bias": None})
        norm = network(buffers={"mean": tensor([3], (1,))})
        net = network(modules={"layer": layer, "norm": norm, "again": layer}, training=True)
        expected = {"layer.weight": ("F32", [2], [1, 2]), "norm.mean": ("F32", [1], [3]), "again.weight": ("F32", [2], [1, 2])}
        for content in (zipped(net), legacy(net), zipped({"model": net, "epoch": 1})):
            self.assertEqual(self.convert(content), expected)
        # TorchScript keeps tensors and parts as attributes.
        script = Named("__torch__.Net", layer=Named("__torch__.Layer", weight=tensor([1, 2], (2,)), training=False))
        self.assertEqual(self.convert(zipped(script)), {"layer.weight": ("F32", [2], [1, 2])})

    def test_numbers_of_a_gpu_and_of_numpy(self):
        root = {"state_dict": state_dict(a=tensor([1], (1,), "cuda.FloatStorage")), "best": Named("numpy.core.multiarray.scalar", 5)}
        for content in (zipped(root), legacy(root)):
            self.assertEqual(self.convert(content), {"a": ("F32", [1], [1])})

    def test_files_in_several_parts(self):
        parts = {"model-1.bin": zipped(state_dict(a=tensor([1], (1,)))), "model-2.bin": legacy(state_dict(b=tensor([2], (1,))))}
        folder = self.dir / "parts"
        folder.mkdir()
        for name, content in parts.items():
            (folder / name).write_bytes(content)
        index = folder / "pytorch_model.bin.index.json"
        out = self.dir / "whole.safetensors"
        for where, code in [({"a": "model-1.bin", "b": "model-2.bin"}, 0), ({"a": "model-1.bin", "b": "../x.bin"}, 3),
                            ({"a": "model-1.bin", "b": "model-3.bin"}, 3), ({"b": "model-1.bin"}, 3)]:  # fmt: skip
            index.write_text(json.dumps({"weight_map": where}))
            done = subprocess.run(command("models", "convert", "-o", out, index), capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(read_safetensors(out)[0], {"a": ("F32", [1], [1]), "b": ("F32", [1], [2])})

    def test_lpips_is_made_of_two_files(self):
        shapes = {"0": (64, 3, 11, 11), "3": (192, 64, 5, 5), "6": (384, 192, 3, 3), "8": (256, 384, 3, 3),
                  "10": (256, 256, 3, 3)}  # fmt: skip
        zeros = {f"features.{i}.weight": tensor(None, shape, "HalfStorage") for i, shape in shapes.items()}
        zeros |= {f"features.{i}.bias": tensor(None, shape[:1], "HalfStorage") for i, shape in shapes.items()}
        features = legacy(state_dict(**zeros, **{"classifier.6.bias": tensor([1], (1,)), "extra": tensor([1], (1,))}))
        model = ["--model", "lpips-alex"]
        for names in ("lin{}.model.1.weight", "{}.1.weight"):
            taps = {names.format(i): tensor(None, (1, shape[0], 1, 1)) for i, shape in enumerate(shapes.values())}
            done = self.run_program(features, legacy(state_dict(**taps)), arguments=model)
            self.assertEqual((done.returncode, done.stdout), (0, f"{self.out}: 15 tensors\n"), done.stderr)
            self.assertIn("leaves out 1 tensors that are no part of lpips-alex: extra", done.stderr)
            found, metadata = read_safetensors(self.out)
            self.assertEqual(set(found), set(zeros) | {f"lin{i}.model.1.weight" for i in range(5)})
            self.assertEqual(metadata, {"source": "0.pth + 1.pth", "model": "lpips-alex"})
            done = subprocess.run(command("models", "check", "lpips-alex", "--file", self.out), capture_output=True, check=False)
            self.assertEqual(done.returncode, 0)
        self.refused(features, "cannot be converted to lpips-alex; 5 missing: lin0.model.1.weight, ", "is it the right file?",
                     arguments=model)  # fmt: skip
        taps["0.1.weight"] = tensor(None, (1, 65, 1, 1))
        self.assertIn("lin0.model.1.weight is [1, 65, 1, 1], expected [1, 64, 1, 1]",
                      self.run_program(features, legacy(state_dict(**taps)), arguments=model).stderr)  # fmt: skip
        self.assertFalse(self.out.exists())
        twice = self.run_program(features, features)
        self.assertIn("1.pth: holds tensor 'classifier.6.bias' a second time", twice.stderr)

    def test_a_pickle_that_would_run_something_is_refused(self):
        witness = self.dir / "was_run"

        class Evil:
            def __init__(self, call, *arguments):
                self.parts = (call, arguments)

            def __reduce__(self):
                return self.parts

        shell = f"touch {witness}"
        for evil in (Evil(os.system, shell), Evil(eval, f"open({str(witness)!r}, 'w')"), Evil(subprocess.Popen, shell),
                     Evil(io.open, str(witness), "w")):  # fmt: skip
            root = state_dict(a=tensor([1], (1,)), b=evil)
            self.refused(zipped(root), "which is no part of a checkpoint and runs programs in other readers; refused")
            self.refused(legacy(root), "which is no part of a checkpoint and runs programs in other readers; refused")
        for content in (b"cos\nsystem\n(S'touch x'\ntR.", b"(S'touch x'\nios\nsystem\n.", b"\x80\x02\x82\x01."):
            self.refused(self.with_pickle(content), "refused")
        # Names that are known, but used for what they are not.
        storage = b"\x80\x02ctorch\nFloatStorage\n"
        self.refused(self.with_pickle(storage + b")R."), "calls what cannot be called")
        self.refused(self.with_pickle(b"\x80\x02K\x01)R."), "calls what cannot be called")
        self.refused(self.with_pickle(b"\x80\x02X\x01\x00\x00\x00xQ."), "refers to something that is no storage")
        # What is unknown is an object of which nothing is known.
        self.assertEqual(set(self.convert(zipped(state_dict(a=tensor([1], (1,)), b=Evil(print, shell), c=Path("x"))))), {"a"})
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
                        one((1 << 40,), (0,)), one((1 << 47, 1 << 47), (1, 1)), one((2, 2), (1 << 47, 1 << 47))):  # fmt: skip
            self.refused(content, "tensor 't' reaches beyond its numbers")
        for content in (one((-1,), (1,)), one((2,), (1, 1)), one((1,) * 40, (1,) * 40), one((2.0,), (1,)),
                        one((True,), (1,)), one((1,), (1,), offset=-1), one((1 << 62,), (1 << 62,))):  # fmt: skip
            self.refused(content, "is malformed")

    def test_damaged_files(self):
        root = state_dict(a=tensor([1, 2, 3], (3,)))
        for content in (zipped(root), legacy(root)):
            for size in range(0, len(content), 29):
                self.refused(content[:size], "0.pth: ")
        self.refused(zipped(root, compression=zipfile.ZIP_DEFLATED), "is compressed or damaged")
        self.refused(zipped(root, byteorder=b"big"), "big-endian")
        self.refused(b"<html>not found</html>", "is neither a checkpoint of PyTorch nor a safetensors file")
        self.refused(struct.pack("<Q", 1 << 40) + b"{" + b" " * 64, "is cut off or no safetensors file")
        for header in (b'{"a":1}', b"{", b'{"a":{"dtype":"F32","shape":[9],"data_offsets":[0,36]}}'):
            self.refused(struct.pack("<Q", len(header)) + header + b" " * 16, "0.pth: ")
        self.refused(pickle.dumps({"a": 1}, 2), "is a pickle, but no checkpoint of PyTorch")
        stream = io.BytesIO()
        with zipfile.ZipFile(stream, "w") as archive:
            archive.writestr("photos/1.jpg", b"x" * 100)
        self.refused(stream.getvalue(), "no checkpoint of PyTorch (it has no data.pkl)")
        _, found = pickle_of(root)
        name = "archive/data/" + next(iter(found))
        lacking = zipped(root).replace(name.encode(), name[:-1].encode() + b"x")
        self.refused(lacking, "lacks its part 'archive/data/")

    def test_mistakes_on_the_command_line(self):
        good = self.dir / "good.pth"
        good.write_bytes(zipped(state_dict(a=tensor([1], (1,)))))
        env = os.environ | {"ORACLEGS_MODELS": str(self.dir / "models")}
        for words, code, said in [(["-o", "o", self.dir / "none.pth"], 3, "none.pth: cannot open: No such file"),
                                  (["-o", "o"], 2, "needs the files"), ([good], 2, "--out FILE.safetensors or --model"),
                                  (["--model", "vgt", good], 2, "vggt-commercial"),
                                  (["-o", good, good], 2, "is one of the files to convert"),
                                  (["--model", "seva", good], 3, "cannot be converted to seva; 1146 missing"),
                                  (["-o", good / "in/o", good], 4, "good.pth")]:  # fmt: skip
            done = subprocess.run(command("models", "convert", *words), capture_output=True, text=True, env=env, check=False)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(said, done.stderr)
        self.assertFalse((self.dir / "models").exists())


if __name__ == "__main__":
    main()
