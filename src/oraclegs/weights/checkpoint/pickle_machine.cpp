
#include <charconv>
#include <unordered_map>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/weights/checkpoint/pickle_heap.h"

namespace oraclegs {
namespace {

constexpr uint64_t kMaxValues = 4'000'000;  // a checkpoint of ten thousand tensors has half a million
constexpr int kNewestProtocol = 5;

using Values = std::vector<PickleValue>;

class PickleMachine {
 public:
  PickleMachine(std::string_view bytes, PickleHeap* heap) : bytes_(bytes), heap_(heap) {}

  PickleValue Run() {
    while (true) {
      const uint8_t code = Byte();
      if (code == '.') return Pop();
      if (!Literal(code) && !Container(code) && !Memo(code) && !Call(code)) {
        throw InputError(
            "{}: its pickle uses the instruction 0x{:02x}, which checkpoints do not need; refused, get the file from "
            "its "
            "authors",
            heap_->file, code);
      }
    }
  }

  std::string_view rest() const { return bytes_; }

 private:
  [[noreturn]] void Damaged() const { throw InputError("{}: its pickle is damaged; get the file again", heap_->file); }
  [[noreturn]] void TooManyValues() const {
    throw InputError("{}: its pickle has more than {} values; save its state dict alone", heap_->file, kMaxValues);
  }

  std::string_view Take(uint64_t count) {
    if (count > bytes_.size()) throw InputError("{}: its pickle has no end; get the file again", heap_->file);
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }
  uint8_t Byte() { return static_cast<uint8_t>(Take(1).front()); }
  uint64_t Unsigned(size_t width) {
    const std::string_view taken = Take(width);
    uint64_t number = 0;
    for (size_t i = 0; i < width; ++i) number |= uint64_t{static_cast<uint8_t>(taken[i])} << (8 * i);
    return number;
  }
  std::string_view Line() {
    const size_t end = bytes_.find('\n');
    if (end == std::string_view::npos) Damaged();
    const std::string_view line = Take(end + 1);
    return line.substr(0, end);
  }

  void Push(const PickleValue& value) {
    if (++pushed_ > kMaxValues) TooManyValues();
    stack_.push_back(value);
  }
  void PushText(uint64_t length) {
    const std::string_view text = Take(length);
    Push({PickleKind::kText, text.data(), static_cast<int64_t>(text.size())});
  }
  void PushInteger(int64_t number) { Push({PickleKind::kInteger, nullptr, number}); }
  void PushLong(uint64_t length) {
    if (length > sizeof(int64_t)) return PushText(length);
    uint64_t number = Unsigned(length);
    const bool negative = length > 0 && (number >> (8 * length - 1) & 1) != 0;
    if (negative && length < sizeof(int64_t)) number |= ~uint64_t{0} << (8 * length);
    PushInteger(static_cast<int64_t>(number));
  }

  void Remember(uint64_t key) {
    const PickleValue value = Top();
    if (memo_.size() >= kMaxValues && memo_.count(key) == 0) TooManyValues();
    memo_[key] = value;
  }

  /// A number in digits, as Python 2 wrote those of more than 32 bits; "01" and "00" are truth values.
  void PushDigits() {
    const std::string_view digits = Line();
    if (digits == "01" || digits == "00") return Push({PickleKind::kBool, nullptr, digits == "01"});
    int64_t number = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (error != std::errc() || end != digits.data() + digits.size()) Damaged();
    PushInteger(number);
  }

  PickleValue& Top() {
    if (stack_.empty() || stack_.back().kind == PickleKind::kMark) Damaged();
    return stack_.back();
  }
  PickleValue Pop() {
    const PickleValue value = Top();
    stack_.pop_back();
    return value;
  }
  /// Takes the values above the last mark, and the mark, off the stack.
  Values PopMark() {
    size_t mark = stack_.size();
    while (mark > 0 && stack_[mark - 1].kind != PickleKind::kMark) --mark;
    if (mark == 0) Damaged();
    Values values(stack_.begin() + static_cast<std::ptrdiff_t>(mark), stack_.end());
    stack_.resize(mark - 1);
    return values;
  }
  void PushItems(PickleKind kind, Values values) {
    if (kind == PickleKind::kDict && values.size() % 2 != 0) Damaged();
    Push(heap_->Add(kind, std::move(values)));
  }
  void PushTuple(size_t count) {
    Values values(count);
    for (size_t i = count; i > 0; --i) values[i - 1] = Pop();
    PushItems(PickleKind::kTuple, std::move(values));
  }
  /// Adds to the list or dict on top; an object's items are not kept.
  void Extend(PickleKind kind, const Values& values) {
    const PickleValue& top = Top();
    if (kind == PickleKind::kDict && values.size() % 2 != 0) Damaged();
    if (top.kind == PickleKind::kObject) return;
    if (top.kind != kind) Damaged();
    Values& items = heap_->items[top.index()];
    items.insert(items.end(), values.begin(), values.end());
  }
  Values PopSome(size_t count) {
    Values values(count);
    for (size_t i = count; i > 0; --i) values[i - 1] = Pop();
    return values;
  }

  bool Literal(uint8_t code) {
    switch (code) {
      case 0x80:  // PROTO
        if (Byte() > kNewestProtocol) {
          throw InputError("{}: its pickle is of a newer protocol than {}; save it with another one", heap_->file,
                           kNewestProtocol);
        }
        return true;
      case 0x95:  // FRAME
        Take(8);
        return true;
      case 'N':
        Push({});
        return true;
      case 0x88:
      case 0x89:  // NEWTRUE, NEWFALSE
        Push({PickleKind::kBool, nullptr, code == 0x88});
        return true;
      case 'J':
        PushInteger(static_cast<int32_t>(Unsigned(4)));
        return true;
      case 'K':
        PushInteger(Byte());
        return true;
      case 'M':
        PushInteger(static_cast<int64_t>(Unsigned(2)));
        return true;
      case 'I':
        PushDigits();
        return true;
      case 0x8a:  // LONG1
        PushLong(Byte());
        return true;
      case 0x8b:  // LONG4
        PushLong(Unsigned(4));
        return true;
      case 'G':
        Take(8);
        Push({PickleKind::kFloat, nullptr, 0});
        return true;
      case 'X':
      case 'T':
      case 'B':  // BINUNICODE, BINSTRING, BINBYTES
        PushText(Unsigned(4));
        return true;
      case 0x8c:
      case 'U':
      case 'C':  // the short ones
        PushText(Byte());
        return true;
      case 0x8d:
      case 0x8e:
      case 0x96:  // BINUNICODE8, BINBYTES8, BYTEARRAY8
        PushText(Unsigned(8));
        return true;
      default:
        return false;
    }
  }

  bool Container(uint8_t code) {
    switch (code) {
      case '(':
        Push({PickleKind::kMark, nullptr, 0});
        return true;
      case ')':
      case ']':
      case '}':
      case 0x8f:  // EMPTY_SET
        PushItems(code == ')' ? PickleKind::kTuple : code == '}' ? PickleKind::kDict : PickleKind::kList, {});
        return true;
      case 0x85:
      case 0x86:
      case 0x87:  // TUPLE1, TUPLE2, TUPLE3
        PushTuple(code - 0x84u);
        return true;
      case 't':
      case 0x91:  // FROZENSET
        PushItems(PickleKind::kTuple, PopMark());
        return true;
      case 'l':
        PushItems(PickleKind::kList, PopMark());
        return true;
      case 'd':
        PushItems(PickleKind::kDict, PopMark());
        return true;
      case 'a':
        Extend(PickleKind::kList, PopSome(1));
        return true;
      case 'e':
      case 0x90:  // ADDITEMS
        Extend(PickleKind::kList, PopMark());
        return true;
      case 's':
        Extend(PickleKind::kDict, PopSome(2));
        return true;
      case 'u':
        Extend(PickleKind::kDict, PopMark());
        return true;
      default:
        return false;
    }
  }

  bool Memo(uint8_t code) {
    switch (code) {
      case 'q':
        Remember(Byte());
        return true;
      case 'r':
        Remember(Unsigned(4));
        return true;
      case 0x94:  // MEMOIZE
        Remember(memo_.size());
        return true;
      case 'h':
      case 'j': {
        const auto it = memo_.find(Unsigned(code == 'h' ? 1 : 4));
        if (it == memo_.end()) Damaged();
        Push(it->second);
        return true;
      }
      case '0':  // POP
        if (stack_.empty()) Damaged();
        stack_.pop_back();
        return true;
      case '1':  // POP_MARK
        PopMark();
        return true;
      case '2':  // DUP
        Push(Top());
        return true;
      default:
        return false;
    }
  }

  bool Call(uint8_t code) {
    switch (code) {
      case 'c': {  // GLOBAL
        const std::string_view module = Line(), name = Line();
        Push(heap_->AddGlobal(module, name));
        return true;
      }
      case 0x93: {  // STACK_GLOBAL
        const Values words = PopSome(2);
        if (words[0].kind != PickleKind::kText || words[1].kind != PickleKind::kText) Damaged();
        Push(heap_->AddGlobal(words[0].text(), words[1].text()));
        return true;
      }
      case 'R':
      case 0x81: {  // REDUCE, NEWOBJ
        const Values parts = PopSome(2);
        Push(ReduceInCheckpoint(parts[0], parts[1], heap_));
        return true;
      }
      case 0x92: {  // NEWOBJ_EX: class, arguments, named arguments
        const Values parts = PopSome(3);
        Push(ReduceInCheckpoint(parts[0], parts[1], heap_));
        return true;
      }
      case 'b': {
        const PickleValue state = Pop();
        BuildInCheckpoint(Top(), state, heap_);
        return true;
      }
      case 'Q':
        Push(StorageInCheckpoint(Pop(), heap_));
        return true;
      default:
        return false;
    }
  }

  std::string_view bytes_;
  PickleHeap* heap_;
  Values stack_;
  std::unordered_map<uint64_t, PickleValue> memo_;
  uint64_t pushed_ = 0;
};

}  // namespace

PickleValue ReadPickle(std::string_view* bytes, PickleHeap* heap) {
  PickleMachine machine(*bytes, heap);
  const PickleValue value = machine.Run();
  *bytes = machine.rest();
  return value;
}

}  // namespace oraclegs
