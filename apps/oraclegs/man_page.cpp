#include "man_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <utility>

#include "help_text.h"

namespace oraclegs {
namespace {

/// Text that roff prints as it is: no line of it is a request, no '-' becomes a hyphen.
std::string Roff(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\\')
      escaped += "\\e";
    else if (c == '-')
      escaped += "\\-";
    else if (c == '\'')
      escaped += "\\(aq";
    else if (c == '`')
      escaped += "\\(ga";
    else if (c == '^')
      escaped += "\\(ha";
    else if (c == '~')
      escaped += "\\(ti";
    else
      escaped += c;
  }
  return escaped.starts_with('.') ? "\\&" + escaped : escaped;
}

std::string Paragraph(const std::string& head, const std::string& text) {
  return fmt::format(".TP\n.B {}\n{}\n", Roff(head), Roff(text));
}

class OptionsOnce {
 public:
  /// The options of a command, those that an earlier one explained as a reference to it.
  std::string Of(const CommandInfo& command) {
    std::string own;
    std::map<std::string, std::string> elsewhere;  // command -> names
    for (const OptionInfo& option : command.options) {
      if (option.hidden) continue;
      const auto [known, is_new] = explained_.try_emplace({NamesOf(option), ExplanationOf(option)}, command.name);
      if (is_new) {
        own += Paragraph(NamesOf(option), ExplanationOf(option));
      } else {
        std::string& names = elsewhere[known->second];
        names += (names.empty() ? "--" : ", --") + option.name;
      }
    }
    for (const auto& [name, options] : elsewhere) {
      own += fmt::format(".PP\nAs in\n.BR {} :\n{}.\n", Roff(name), Roff(options));
    }
    return own;
  }

 private:
  std::map<std::pair<std::string, std::string>, std::string> explained_;
};

std::string Examples(const std::string& example) {
  std::string text = ".PP\nExample:\n.PP\n.nf\n";
  std::istringstream lines(example);
  for (std::string line; std::getline(lines, line);) {
    text += "    " + Roff(line.substr(std::min(line.find_first_not_of(' '), line.size()))) + "\n";
  }
  return text + ".fi\n";
}

}  // namespace

std::string ManPage(const Catalog& commands, const std::string& version) {
  std::string page = fmt::format(
      ".TH ORACLEGS 1 \"\" \"oraclegs {}\" \"User Commands\"\n"
      ".SH NAME\noraclegs \\- a few photos become a 3D Gaussian splat\n"
      ".SH SYNOPSIS\n.B oraclegs\n.I COMMAND\n[\\fIOPTIONS\\fR]\n"
      ".SH DESCRIPTION\nReconstructs a scene from 3 to 24 photos, on a CPU or an NVIDIA GPU: finds the cameras, the "
      "depth "
      "of the photos, new views and how far these can be relied on, and trains a 3D Gaussian splat on both.\n.PP\n"
      "A flag \\-\\-x is undone by \\-\\-no\\-x. An option that is given twice has the last value.\n"
      ".SH COMMANDS\n",
      version);
  OptionsOnce options;
  for (const CommandInfo& command : commands) {
    page += fmt::format(".SS \"{}\"\n{}.\n.PP\n{}\n", Roff(command.name), Roff(command.help), Roff(UsageOf(command)));
    for (const ArgumentInfo& argument : command.arguments) {
      page += Paragraph(argument.name + " " + argument.value, argument.help);
    }
    page += options.Of(command) + Examples(command.example);
  }
  page += ".SH SETTINGS\nWhat only experiments set, by \\-\\-set NAME=VALUE.\n";
  for (const CommandInfo& command : commands) {
    if (command.name != "reconstruct") continue;
    for (const OptionInfo& setting : command.settings) page += Paragraph(setting.name, ExplanationOf(setting));
  }
  return page +
         ".SH ENVIRONMENT\n"
         ".TP\n.B ORACLEGS_MODELS\nFolder of the networks' weights.\n"
         ".TP\n.B ORACLEGS_PRESETS\nFolder of more presets, NAME.toml.\n"
         ".TP\n.B ORACLEGS_NETWORKS_LIBRARY\nThe library of networks to load.\n"
         ".TP\n.B ORACLEGS_STALL_LIMIT\nSeconds after which a program that does nothing (colmap, ffmpeg) is ended; "
         "120.\n"
         ".TP\n.B HF_TOKEN\nAccess token for weights that need an account.\n"
         ".SH EXIT STATUS\n"
         ".TP\n.B 0\nDone.\n.TP\n.B 2\nA mistake on the command line.\n.TP\n.B 3\nBad input.\n.TP\n.B 4\nThe run "
         "failed.\n.TP\n.B 130\nInterrupted; the same command continues.\n";
}

}  // namespace oraclegs
