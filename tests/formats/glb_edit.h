#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "oraclegs/formats/values.h"

namespace oraclegs {

/// The binary glTF with an edited JSON.
template <class Edit>
std::string EditGlb(const std::string& glb, Edit&& edit) {
  const auto length = LoadLittle<uint32_t>(glb, 12);
  nlohmann::json json = nlohmann::json::parse(glb.substr(20, length));
  edit(json);
  std::string text = json.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string edited = glb.substr(0, 20) + text + glb.substr(20 + length);
  StoreLittle(edited.data() + 8, static_cast<uint32_t>(edited.size()));
  StoreLittle(edited.data() + 12, static_cast<uint32_t>(text.size()));
  return edited;
}

}  // namespace oraclegs
