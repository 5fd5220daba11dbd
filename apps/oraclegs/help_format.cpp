#include "help_format.h"

#include <sstream>

namespace oraclegs {
namespace {

constexpr size_t kNameColumn = 30, kLineWidth = 100;

std::string TwoColumns(std::string name, const std::string& text) {
  std::string out = "  " + name, indent(kNameColumn, ' ');
  if (out.size() + 2 > kNameColumn) {
    out += "\n" + indent;
  } else {
    out.resize(kNameColumn, ' ');
  }
  size_t column = kNameColumn;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (column > kNameColumn && column + 1 + word.size() > kLineWidth) {
      out += "\n" + indent;
      column = kNameColumn;
    }
    if (column > kNameColumn) out += " ", ++column;
    out += word;
    column += word.size();
  }
  return out + "\n";
}

}  // namespace

std::string HelpFormat::make_option(const CLI::Option* option, bool is_positional) const {
  std::string name = make_option_name(option, is_positional);
  const size_t negated = name.find("{false}");  // "--x,--no-x{false}": the way CLI11 spells a flag that can be undone
  if (negated != std::string::npos) name.erase(negated);
  return TwoColumns(name + make_option_opts(option), make_option_desc(option));
}

std::string HelpFormat::make_option_opts(const CLI::Option* option) const {
  return option->get_type_size() == 0 ? "" : " " + option->get_type_name();
}

std::string HelpFormat::make_subcommand(const CLI::App* command) const {
  return TwoColumns(command->get_name(), command->get_description());
}

std::string HelpFormat::make_footer(const CLI::App* app) const {
  const std::string footer = app->get_footer();
  return footer.empty() ? "" : "\n" + footer + "\n";
}

}  // namespace oraclegs
