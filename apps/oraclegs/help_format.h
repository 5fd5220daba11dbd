#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace oraclegs {

/// --help in two columns with the descriptions wrapped, which CLI11 does not do by itself.
class HelpFormat : public CLI::Formatter {
 public:
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  std::string make_option_opts(const CLI::Option* option) const override;
  std::string make_subcommand(const CLI::App* command) const override;
  std::string make_footer(const CLI::App* app) const override;
};

}  // namespace oraclegs
