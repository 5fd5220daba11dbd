"""Reads what PyTorch's torch.save wrote: the zip since 1.6, and the format before it. For convert_weights.py.

Runs nothing of what a file says. A pickle is a program; this reader knows only the instructions of which state dicts
are made, and all that these can build is tensors, dicts, lists, numbers and texts.
"""

import collections
import io
import math
import pickletools
import struct
import zipfile

BYTES = {"F64": 8, "F32": 4, "F16": 2, "BF16": 2, "I64": 8, "I32": 4, "I16": 2, "I8": 1, "U8": 1, "BOOL": 1}
STORAGES = {"DoubleStorage": "F64", "FloatStorage": "F32", "HalfStorage": "F16", "BFloat16Storage": "BF16",
            "LongStorage": "I64", "IntStorage": "I32", "ShortStorage": "I16", "CharStorage": "I8",
            "ByteStorage": "U8", "BoolStorage": "BOOL"}  # fmt: skip

MAGIC = 0x1950A86A20F9469CFC6C  # of the format before PyTorch 1.6
LEGACY_VERSION = 1001
MAX_DIMENSIONS = 16


class BadFile(Exception):
    """What is wrong with a file, in one line."""


class Storage:
    """A row of numbers in the file. `begin` is known from the start, or when the pickle was read."""

    def __init__(self, dtype, numel):
        self.dtype, self.numel, self.begin = dtype, numel, None


class Tensor(collections.namedtuple("Tensor", "storage offset shape strides")):
    def numel(self):
        return math.prod(self.shape)

    def is_contiguous(self):
        expected = 1
        for size, stride in zip(reversed(self.shape), reversed(self.strides)):
            if size != 1 and stride != expected:
                return False
            expected *= size
        return True


def contiguous(storage, shape):
    strides = [math.prod(shape[i + 1 :]) for i in range(len(shape))]
    return Tensor(storage, 0, tuple(shape), tuple(strides))


def whole(*numbers):
    return all(type(n) is int and 0 <= n < 1 << 62 for n in numbers)


# ---- pickles ----


class Known:
    """A name that a pickle may say. It is not the thing itself: calling it does what is written here."""

    def __init__(self, call=None, dtype=None):
        self.call, self.dtype = call, dtype


def rebuild_tensor(storage, offset, shape, strides, *_):
    shape, strides = tuple(shape), tuple(strides)
    fits = len(shape) == len(strides) <= MAX_DIMENSIONS and whole(offset, *shape, *strides)
    if not isinstance(storage, Storage) or not fits:
        raise BadFile("a tensor is malformed; get the file again")
    tensor = Tensor(storage, offset, shape, strides)
    last = offset + sum((size - 1) * stride for size, stride in zip(shape, strides))
    if tensor.numel() > 0 and (last >= storage.numel or tensor.numel() > storage.numel):
        raise BadFile("a tensor reaches beyond its numbers; get the file again")
    return tensor


def rebuild_parameter(data, *_):
    if not isinstance(data, Tensor):
        raise BadFile("a parameter holds no tensor; get the file again")
    return data


KNOWN = {
    "collections OrderedDict": Known(lambda pairs=(): Unpickler.pairs([part for pair in pairs for part in pair])),
    "torch._utils _rebuild_tensor": Known(rebuild_tensor),
    "torch._utils _rebuild_tensor_v2": Known(rebuild_tensor),
    "torch._utils _rebuild_parameter": Known(rebuild_parameter),
    "torch Size": Known(tuple),
    **{f"torch {name}": Known(dtype=dtype) for name, dtype in STORAGES.items()},
}


class Unpickler:
    """Runs the instructions of one pickle of a stream; `storages` collects {key: Storage}."""

    MARK = object()
    CONSTANTS = {"NONE": None, "NEWTRUE": True, "NEWFALSE": False, "EMPTY_TUPLE": ()}
    LITERALS = {"BININT", "BININT1", "BININT2", "LONG1", "BINFLOAT", "BINUNICODE", "SHORT_BINUNICODE", "BINUNICODE8",
                "BINSTRING", "SHORT_BINSTRING"}  # fmt: skip
    TUPLES = {"TUPLE1": 1, "TUPLE2": 2, "TUPLE3": 3}

    def __init__(self, storages):
        self.storages, self.stack, self.memo = storages, [], {}

    def load(self, stream):
        try:
            for opcode, argument, _ in pickletools.genops(stream):
                if opcode.name == "STOP":
                    return self.stack.pop()
                self.step(opcode.name, argument)
        except (ValueError, IndexError, KeyError, TypeError, AttributeError, OverflowError) as error:
            raise BadFile("its pickle is damaged; get the file again") from error
        raise BadFile("its pickle has no end; get the file again")

    def step(self, name, argument):
        stack = self.stack
        if name in ("PROTO", "FRAME"):
            return
        if name in self.CONSTANTS:
            stack.append(self.CONSTANTS[name])
        elif name in self.LITERALS:
            stack.append(argument)
        elif name == "MARK":
            stack.append(self.MARK)
        elif name in ("EMPTY_DICT", "EMPTY_LIST"):
            stack.append({} if name == "EMPTY_DICT" else [])
        elif name in self.TUPLES:
            count = self.TUPLES[name]
            stack[-count:] = [tuple(stack[-count:])]
        elif name in ("TUPLE", "LIST", "DICT"):
            items = self.above_mark()
            stack.append({"TUPLE": tuple, "LIST": list, "DICT": self.pairs}[name](items))
        elif name in ("BINPUT", "LONG_BINPUT", "MEMOIZE"):
            self.memo[len(self.memo) if name == "MEMOIZE" else argument] = stack[-1]
        elif name in ("BINGET", "LONG_BINGET"):
            stack.append(self.memo[argument])
        elif name in ("APPEND", "APPENDS"):
            items = [stack.pop()] if name == "APPEND" else self.above_mark()
            self.expect(list).extend(items)
        elif name in ("SETITEM", "SETITEMS"):
            items = [stack.pop(-2), stack.pop()] if name == "SETITEM" else self.above_mark()
            self.expect(dict).update(self.pairs(items))
        elif name in ("GLOBAL", "STACK_GLOBAL"):
            if name == "STACK_GLOBAL":
                argument = " ".join([stack.pop(-2), stack.pop()])
            if argument not in KNOWN:
                raise BadFile(f"its pickle asks for {argument!r:.120}, which is no part of a state dict; refused")
            stack.append(KNOWN[argument])
        elif name == "REDUCE":
            arguments, known = stack.pop(), stack.pop()
            if not isinstance(known, Known) or known.call is None:
                raise BadFile("its pickle calls what cannot be called; refused")
            stack.append(known.call(*arguments))
        elif name == "BUILD":
            stack.pop()  # attributes, such as the version numbers of modules
            self.expect(dict)
        elif name == "BINPERSID":
            stack.append(self.storage(stack.pop()))
        else:
            raise BadFile(f"its pickle uses the instruction {name}, which state dicts do not need; refused")

    def above_mark(self):
        items = []
        while self.stack[-1] is not self.MARK:
            items.append(self.stack.pop())
        self.stack.pop()
        return items[::-1]

    @staticmethod
    def pairs(items):
        if not all(isinstance(key, (str, int)) for key in items[::2]):
            raise BadFile("its pickle has a key that is neither text nor number; refused")
        return dict(zip(items[::2], items[1::2]))

    def expect(self, kind):
        if not isinstance(self.stack[-1], kind):
            raise BadFile("its pickle is damaged; get the file again")
        return self.stack[-1]

    def storage(self, name):
        if not isinstance(name, tuple) or len(name) not in (5, 6) or name[0] != "storage":
            raise BadFile("its pickle refers to something that is no storage; refused")
        kind, key, numel = name[1], name[2], name[4]
        if len(name) == 6 and name[5] is not None:
            raise BadFile("it was written by a PyTorch before 0.4; load and save it with a newer one")
        if not isinstance(kind, Known) or kind.dtype is None or type(key) is not str or not whole(numel):
            raise BadFile("a storage is malformed; get the file again")
        known = self.storages.setdefault(key, Storage(kind.dtype, numel))
        if (known.dtype, known.numel) != (kind.dtype, numel):
            raise BadFile(f"storage {key!r:.40} is said to be two different things; get the file again")
        return known


# ---- files ----


def read_zip(data, stream):
    """A checkpoint since PyTorch 1.6: a zip of data.pkl and, uncompressed, data/KEY for each storage."""
    with zipfile.ZipFile(stream) as archive:
        entries = {info.filename: info for info in archive.infolist()}
    pickles = [name for name in entries if name.count("/") == 1 and name.endswith("/data.pkl")]
    if len(pickles) != 1:
        raise BadFile("is a zip, but no checkpoint of PyTorch (it has no data.pkl); name the checkpoint itself")
    folder = pickles[0][: -len("data.pkl")]

    def place(name):
        info = entries.get(folder + name)
        if info is None:
            raise BadFile(f"lacks its part {name!r:.60}; the file is incomplete, get it again")
        local = data[info.header_offset : info.header_offset + 30]
        if info.compress_type != zipfile.ZIP_STORED or len(local) < 30 or local[:4] != b"PK\3\4":
            raise BadFile(f"its part {name!r:.60} is compressed or damaged; get the file again")
        begin = info.header_offset + 30 + sum(struct.unpack("<HH", local[26:30]))
        if begin + info.file_size > len(data):
            raise BadFile("is cut off; get it again")
        return begin, info.file_size

    def content(name):
        begin, size = place(name)
        return data[begin : begin + size]

    if folder + "byteorder" in entries and content("byteorder") != b"little":
        raise BadFile("was written on a big-endian machine; load and save it on another one")
    storages = {}
    root = Unpickler(storages).load(io.BytesIO(content("data.pkl")))
    for key, storage in storages.items():
        storage.begin, size = place("data/" + key)
        if size < storage.numel * BYTES[storage.dtype]:
            raise BadFile(f"storage {key!r:.40} is cut off; get the file again")
    return root


def read_legacy(data):
    """A checkpoint before PyTorch 1.6: five pickles, then for each storage its length and its numbers."""
    data.seek(0)
    if Unpickler({}).load(data) != MAGIC or Unpickler({}).load(data) != LEGACY_VERSION:
        raise BadFile("is no checkpoint of PyTorch; name the published file")
    system = Unpickler({}).load(data)
    if not isinstance(system, dict) or system.get("little_endian") is not True:
        raise BadFile("was written on a big-endian machine; load and save it on another one")
    storages = {}
    root = Unpickler(storages).load(data)
    keys = Unpickler({}).load(data)
    texts = isinstance(keys, list) and all(isinstance(key, str) for key in keys)
    if not texts or sorted(keys) != sorted(storages):
        raise BadFile("its storages are not those of its tensors; get the file again")
    position = data.tell()
    for key in keys:
        storage = storages[key]
        length = data[position : position + 8]
        storage.begin = position + 8
        position = storage.begin + storage.numel * BYTES[storage.dtype]
        if len(length) < 8 or struct.unpack("<q", length)[0] != storage.numel or position > len(data):
            raise BadFile("is cut off; get it again")
    return root
