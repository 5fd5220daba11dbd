#include "oraclegs/core/unique_json.h"

#include <set>
#include <vector>

#include "oraclegs/core/error.h"

namespace oraclegs {

using nlohmann::json;

namespace {

constexpr size_t kDeepestJson = 64;  // levels; the library copies values by recursion

/// Looks at a text before it is parsed. The library's parser with a callback would do so on the way, but goes over all
/// items of a list again for each object in it.
class JsonWatch : public nlohmann::json_sax<json> {
 public:
  virtual void OnTooDeep() const = 0;
  virtual void OnKey(const std::string&) {}
  virtual void OnObject(bool /*begins*/) {}

  bool start_object(size_t) override { return Open(true); }
  bool start_array(size_t) override { return Open(false); }
  bool end_object() override { return --depth_, OnObject(false), true; }
  bool end_array() override { return --depth_, true; }
  bool key(string_t& name) override { return OnKey(name), true; }
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool parse_error(size_t, const std::string&, const json::exception&) override { return false; }  // the parser says it

 private:
  bool Open(bool is_object) {
    if (depth_++ >= kDeepestJson) OnTooDeep();
    if (is_object) OnObject(true);
    return true;
  }

  size_t depth_ = 0;
};

class DepthWatch : public JsonWatch {
  void OnTooDeep() const override {
    throw json::other_error::create(501, fmt::format("nested more than {} levels deep", kDeepestJson), nullptr);
  }
};

class UniqueWatch : public JsonWatch {
 public:
  UniqueWatch(const std::string& file, const std::string& part) : file_(file), part_(part) {}

 private:
  void OnTooDeep() const override {
    throw InputError("{}: the {} is nested more than {} levels deep; write the file again", file_, part_, kDeepestJson);
  }
  void OnObject(bool begins) override {
    if (begins) return static_cast<void>(keys_.emplace_back());
    keys_.pop_back();
  }
  void OnKey(const std::string& name) override {
    if (keys_.back().insert(name).second) return;
    throw InputError("{}: the {} names {} twice; write the file again", file_, part_, QuotedForMessage(name));
  }

  const std::string &file_, &part_;
  std::vector<std::set<std::string>> keys_;
};

}  // namespace

json ParseUniqueJson(std::string_view text, const std::string& file, const std::string& part) {
  try {
    UniqueWatch watch(file, part);
    json::sax_parse(text.begin(), text.end(), &watch);
    return json::parse(text.begin(), text.end());
  } catch (const json::parse_error& error) {
    throw InputError("{}: the {} is not valid JSON (at byte {}); the file is damaged, get it again", file, part,
                     error.byte);
  } catch (const json::exception&) {
    throw InputError("{}: the {} is not valid JSON; the file is damaged, get it again", file, part);
  }
}

json ParseJson(std::string_view text) {
  DepthWatch watch;
  json::sax_parse(text.begin(), text.end(), &watch);
  return json::parse(text.begin(), text.end());
}

json ParseJsonOrDiscard(std::string_view text) {
  try {
    return ParseJson(text);
  } catch (const json::exception&) {
    return json::value_t::discarded;
  }
}

std::string QuotedForMessage(const std::string& name) {
  return json(name.substr(0, 120)).dump(-1, ' ', true, json::error_handler_t::replace);
}

}  // namespace oraclegs
