"""Files as torch.save writes them, and as libraries built on PyTorch do, made with pickle alone."""

import collections
import functools
import io
import json
import math
import pickle
import struct
import sys
import types
import zipfile



def stand_in(module, name, thing):
    """Gives `thing` the name under which pickle writes it down; nothing of PyTorch is there."""
    parts = module.split(".")
    for end in range(1, len(parts) + 1):
        sys.modules.setdefault(".".join(parts[:end]), types.ModuleType(".".join(parts[:end])))
    thing.__module__, thing.__qualname__, thing.__name__ = module, name, name
    setattr(sys.modules[module], name, thing)
    return thing


@functools.cache
def function(module, name):
    def pickled(*_):
        raise AssertionError("only its name is used")

    return stand_in(module, name, pickled)


FORMATS = {"FloatStorage": "f", "HalfStorage": "e", "DoubleStorage": "d", "LongStorage": "q", "BFloat16Storage": "H",
           "cuda.FloatStorage": "f"}  # fmt: skip
STORAGES = {kind: stand_in(*f"torch.{kind}".rsplit(".", 1), type(kind, (), {})) for kind in FORMATS}
REBUILD = function("torch._utils", "_rebuild_tensor_v2")
REBUILD_OLD = function("torch._utils", "_rebuild_tensor")
REBUILD_PARAMETER = function("torch._utils", "_rebuild_parameter")


class Numbers:
    """A storage."""

    count = 0

    def __init__(self, values, kind="FloatStorage"):
        Numbers.count += 1
        self.key, self.values, self.kind = str(Numbers.count), values, kind

    def bytes(self):
        if not any(self.values):
            return bytes(len(self.values) * struct.calcsize(FORMATS[self.kind]))
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


class Named:
    """What another library's function made of some arguments, with attributes."""

    def __init__(self, name, *arguments, **attributes):
        self.parts = (function(*name.rsplit(".", 1)), arguments, attributes or None)

    def __reduce__(self):
        return self.parts


def network(parameters=(), buffers=(), modules=(), **attributes):
    """A torch.nn.Module that is saved as a whole."""
    dicts = {"_parameters": parameters, "_buffers": buffers, "_modules": modules}
    state = {name: collections.OrderedDict(content) for name, content in dicts.items()}
    return Named("mine.Net", **state, **attributes)


def tensor(values, shape, kind="FloatStorage"):
    """Without values it holds zeros."""
    if values is None:
        values = [0] * math.prod(shape)
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
