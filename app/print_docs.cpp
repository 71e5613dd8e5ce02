// Sources: man(7) and groff_char(7) for the page; the manuals of bash (Programmable Completion), zsh (Completion System: _arguments) and
// fish (complete) for the scripts.
#include "app/print_docs.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "pipeline/kit/engine_kit.h"
#include "pipeline/options/option_json.h"
#include "pipeline/options/presets.h"
#include "pipeline/scene/scene_keys.h"

namespace cloudbake {

namespace {

using std::string;
using std::string_view;

constexpr const char* kSummary = "bake mesh clouds";

// An option as it is documented: a row of the table, or an option that every command has.
struct DocOption {
  string name, letter, unit, help, fallback, group;
  std::vector<string> choices;
};

std::vector<DocOption> optionsOf(const CommandSpec& command) {
  std::vector<DocOption> options;
  if (*command.output) options.push_back({"output", "o", command.output, command.output_help, "", "Options", {}});
  for (const Option& o : optionTable())
    if (o.commands & command.bit) options.push_back({o.name, "", o.unit, o.help, defaultOf(o), groupOf(o, command.bit), optionChoices(o)});
  options.push_back({"quiet", "q", "", kQuietHelp, "", "Options", {}});
  options.push_back({"help", "h", "", "print the help of the command", "", "Options", {}});
  options.push_back({"help-all", "", "", "print the help with every option", "", "Options", {}});
  // Groups stay together, the general options first.
  std::stable_partition(options.begin(), options.end(), [](const DocOption& o) { return o.group == "Options"; });
  return options;
}

// Whether -o may be left out.
bool mayOmitOutput(const CommandSpec& command) { return !requiresOutput(command) || command.bit == kView; }
bool takesPreset(const CommandSpec& command) { return (command.bit & (kGrow | kMeasure)) != 0; }
bool takesFile(const DocOption& option) { return option.unit.starts_with("FILE") || option.unit == "PATH"; }
bool takesFolder(const DocOption& option) { return option.unit == "DIR" || option.unit == "FOLDER"; }

template <class Texts>
string join(const Texts& texts, string_view separator) {
  string all;
  for (const auto& text : texts) all += (all.empty() ? "" : string(separator)) + string(text);
  return all;
}

string presetWords() {
  std::vector<string> names;
  for (const Preset& preset : presets()) names.emplace_back(preset.name);
  return join(names, " ");
}

// The names that a command takes beside files.
string inputWords(const CommandSpec& command) {
  return takesPreset(command) ? presetWords() : command.bit == kShader ? join(engineNames(), " ") : "";
}

string escaped(string_view text, string_view specials) {
  string out;
  for (const char c : text) {
    if (specials.find(c) != string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

// The lines of a command's examples, without their heading.
std::vector<string> exampleLines(const CommandSpec& command) {
  std::vector<string> lines;
  const string_view text = command.examples;
  for (size_t begin = text.find('\n'); begin < text.size();) {
    const size_t first = std::min(text.find_first_not_of(" \n", begin), text.size()), end = std::min(text.find('\n', first), text.size());
    lines.emplace_back(text.substr(first, end - first));
    begin = end;
  }
  return lines;
}

// Returns the code point at `at`, and moves `at` past it. The text is our own, so it is well-formed UTF-8.
char32_t nextCodePoint(string_view text, size_t& at) {
  const auto byte = [&](size_t i) { return char32_t(static_cast<unsigned char>(text[i])); };
  const char32_t lead = byte(at++);
  if (lead < 0x80) return lead;
  const int tail = lead >= 0xF0 ? 3 : lead >= 0xE0 ? 2 : 1;
  char32_t code = lead & (0x3F >> tail);
  for (int i = 0; i < tail; ++i) code = code << 6 | (byte(at++) & 0x3F);
  return code;
}

// Text for troff. What troff would read as a command or replace by a typographic form is escaped, so that the source is plain ASCII.
string troff(string_view text) {
  string out = text.starts_with('.') ? "\\&" : "";
  for (size_t at = 0; at < text.size();) {
    const char32_t code = nextCodePoint(text, at);
    string escape(1, char(code));
    switch (code) {
      case '\\': escape = "\\(rs"; break;
      case '-': escape = "\\-"; break;
      case '^': escape = "\\(ha"; break;
      case '~': escape = "\\(ti"; break;
      case '`': escape = "\\(ga"; break;
      case '\'': escape = "\\(aq"; break;
      case '"': escape = "\\(dq"; break;
      default:
        if (code >= 0x80) escape = fmt::format("\\[u{:04X}]", uint32_t(code));
    }
    out += escape;
  }
  return out;
}

string bold(string_view text) { return "\\fB" + troff(text) + "\\fR"; }
string italic(string_view text) { return "\\fI" + troff(text) + "\\fR"; }

string manOption(const DocOption& option) {
  string head = option.letter.empty() ? "" : bold("-" + option.letter) + ", ";
  head += bold("--" + option.name) + (option.unit.empty() ? "" : " " + italic(option.unit));
  return ".TP\n" + head + "\n" + troff(option.help) + (option.fallback.empty() ? "" : troff(" [" + option.fallback + "]")) + "\n";
}

string manSynopsis(const CommandSpec& command) {
  const string output = bold("-o") + " " + italic(command.output);
  return bold("cloudbake " + string(command.name)) + " " + italic(command.input) + " [" + italic("OPTION") + " ...]" +
         (!*command.output         ? ""
          : mayOmitOutput(command) ? " [" + output + "]"
                                   : " " + output) +
         "\n";
}

string manCommand(const CommandSpec& command) {
  string page = ".SS " + string(command.name) + "\n" + manSynopsis(command) + ".PP\n" + troff(command.help) + ".\n";
  if (command.bit == kGrow) page += "Presets: " + troff(presetWords()) + ".\n";
  if (command.bit == kShader) {
    std::vector<string> engines;
    for (const string& name : engineNames()) engines.push_back(name + " (" + engineTitle(name) + ")");
    page += "Engines: " + troff(join(engines, ", ")) + ".\n";
  }
  string group = "Options";
  for (const DocOption& option : optionsOf(command)) {
    if (option.group != group) page += ".PP\n" + bold(option.group) + "\n";
    group = option.group;
    page += manOption(option);
  }
  return page;
}

string manPage(std::span<const CommandSpec> commands) {
  string page = ".\\\" Written by `cloudbake print-docs man`.\n.TH CLOUDBAKE 1 \"\" \"cloudbake " + troff(CLOUDBAKE_VERSION) +
                "\" \"User Commands\"\n.SH NAME\ncloudbake \\- " + troff(kSummary) + "\n.SH SYNOPSIS\n";
  for (const CommandSpec& command : commands) page += (&command == &commands.front() ? "" : ".br\n") + manSynopsis(command);
  page += ".br\n" + bold("cloudbake") + " [" + italic("COMMAND") + "] " + bold("--help") + " | " + bold("--version") + "\n";
  page +=
      ".SH DESCRIPTION\ncloudbake bakes mesh clouds, offline: it grows clouds with an L\\-system, or takes an artist\\(aqs sculpt as it "
      "is, measures how much cloud lies in every direction from every vertex, and writes glTF whose vertices carry four floats in UV "
      "channels: where the cloud\\(aqs bulk lies, and how thick it is there.\n"
      ".PP\nOutputs are replaced completely or not at all. Errors and warnings are lines on standard error.\n";

  page += ".SH COMMANDS\nDefaults are in brackets.\n";
  for (const CommandSpec& command : commands) page += manCommand(command);
  page += ".SH EXIT STATUS\n";
  for (const auto& [code, meaning] : kExitCodes) page += ".TP\n" + bold(std::to_string(int(code))) + "\n" + troff(meaning) + "\n";
  page += ".SH EXAMPLES\n.nf\n.RS 4\n";
  for (const CommandSpec& command : commands)
    for (const std::string& line : exampleLines(command)) page += troff(line) + "\n";
  return page + ".RE\n.fi\n";
}

// The branch of a command: after an option its values, with options of the same values in one case; else options, presets and files.
string bashCommand(const CommandSpec& command) {
  std::vector<string> flags;
  std::map<string, std::vector<string>> options_of_reply;
  for (const DocOption& option : optionsOf(command)) {
    std::vector<string> names = {"--" + option.name};
    if (!option.letter.empty()) names.push_back("-" + option.letter);
    flags.insert(flags.end(), names.begin(), names.end());
    if (option.unit.empty() || isOptionalUnit(option.unit)) continue;
    const string reply = !option.choices.empty() ? "words='" + join(option.choices, " ") + "'"
                         : takesFile(option)     ? "files=-f"
                         : takesFolder(option)   ? "files=-d"
                                                 : "return";
    options_of_reply[reply].push_back(join(names, "|"));
  }
  string text = "        1," + string(command.name) + ")\n            case $previous in\n";
  for (const auto& [reply, options] : options_of_reply) text += "                " + join(options, "|") + ") " + reply + " ;;\n";
  return text + "                *) words='" + inputWords(command) + "' files=-f options='" + join(flags, " ") +
         "' ;;\n            esac ;;\n";
}

string bashCompletion(std::span<const CommandSpec> commands) {
  std::vector<string> names;
  string cases;
  for (const CommandSpec& command : commands) {
    names.emplace_back(command.name);
    cases += bashCommand(command);
  }
  return R"(# Completion of cloudbake for bash, written by `cloudbake print-docs bash`.
_cloudbake() {
    local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]} words='' options='' files=''
    # bash splits --option=value into three words.
    if [[ $current == '=' ]]; then
        current=''
    elif [[ $previous == '=' ]]; then
        previous=${COMP_WORDS[COMP_CWORD-2]}
    fi

    COMPREPLY=()
    case $((COMP_CWORD > 1)),${COMP_WORDS[1]} in
        0,*) words=')" +
         join(names, " ") + R"(' options='--help --version' ;;
)" + cases +
         R"(    esac
    [[ $current == -* ]] && words=$options files=''

    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
    if [[ $files ]]; then
        compopt -o filenames 2>/dev/null
        mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen "$files" -- "$current")
    fi
}
complete -F _cloudbake cloudbake
)";
}

// Text inside '…' of a zsh specification, where _arguments interprets brackets and colons.
string zshText(string_view text) {
  string out;
  for (const char c : escaped(text, "\\[]:")) out += c == '\'' ? "'\\''" : string(1, c);
  return out;
}

string zshOption(const DocOption& option) {
  const string help = "[" + zshText(option.help) + "]";
  const string action = !option.choices.empty() ? "(" + join(option.choices, " ") + ")"
                        : takesFile(option)     ? "_files"
                        : takesFolder(option)   ? "_files -/"
                                                : " ";
  const string colon = isOptionalUnit(option.unit) ? "::" : ":";
  const string value = option.unit.empty() ? "" : colon + zshText(option.unit) + ":" + action;
  const string name = "--" + option.name + (option.unit.empty() ? "" : "=");
  if (option.letter.empty()) return "'" + name + help + value + "'";
  return "'(-" + option.letter + " --" + option.name + ")'{-" + option.letter + (option.unit.empty() ? "" : "+") + "," + name + "}'" +
         help + value + "'";
}

string zshCompletion(std::span<const CommandSpec> commands) {
  string names, cases;
  for (const CommandSpec& command : commands) {
    names += "    '" + string(command.name) + ":" + zshText(command.help) + "'\n";
    cases += "    " + string(command.name) + ")\n      _arguments \\\n";
    for (const DocOption& option : optionsOf(command)) cases += "        " + zshOption(option) + " \\\n";
    cases += "        '*:" + zshText(command.input) + ":" +
             (takesPreset(command)     ? "_cloudbake_presets"
              : command.bit == kShader ? "_cloudbake_engines"
                                       : "_files") +
             "'\n      ;;\n";
  }
  return "#compdef cloudbake\n# Completion of cloudbake for zsh, written by `cloudbake print-docs zsh`.\n\n_cloudbake_presets() {\n"
         "  _alternative 'presets:preset:(" +
         presetWords() + R"()' 'files:file:_files'
}

_cloudbake_engines() {
  _alternative 'engines:engine:()" +
         join(engineNames(), " ") + R"()' 'files:file:_files'
}

_cloudbake() {
  local -a commands=(
)" + names +
         R"(  )
  if (( CURRENT == 2 )); then
    if [[ $PREFIX == -* ]]; then
      compadd -- --help --version
    else
      _describe 'command' commands
    fi
    return
  fi
  shift words
  (( CURRENT-- ))
  case $words[1] in
)" + cases +
         R"(  esac
}

# Autoloaded by its first call, or sourced.
if [[ $funcstack[1] == _cloudbake ]]; then
  _cloudbake "$@"
else
  compdef _cloudbake cloudbake
fi
)";
}

string fishQuoted(string_view text) { return "'" + escaped(text, "\\'") + "'"; }

string fishCompletion(std::span<const CommandSpec> commands) {
  string script = "# Completion of cloudbake for fish, written by `cloudbake print-docs fish`.\ncomplete -c cloudbake -f\n";
  for (const char* flag : {"help", "version"}) script += string("complete -c cloudbake -n __fish_use_subcommand -l ") + flag + "\n";
  for (const CommandSpec& command : commands) {
    script += string("complete -c cloudbake -n __fish_use_subcommand -a ") + command.name + " -d " + fishQuoted(command.help) + "\n";
    const string line = string("complete -c cloudbake -n '__fish_seen_subcommand_from ") + command.name + "'";
    script += line + " -F\n";
    if (const string words = inputWords(command); !words.empty())
      script += line + " -a " + fishQuoted(words) + (takesPreset(command) ? " -d preset\n" : " -d engine\n");
    for (const DocOption& option : optionsOf(command)) {
      const string value = option.unit.empty()           ? ""
                           : isOptionalUnit(option.unit) ? ""
                           : !option.choices.empty()     ? " -x -a " + fishQuoted(join(option.choices, " "))
                           : takesFile(option)           ? " -r -F"
                           : takesFolder(option)         ? " -x -a '(__fish_complete_directories)'"
                                                         : " -x";
      script += line + (option.letter.empty() ? "" : " -s " + option.letter) + " -l " + option.name + value + " -d " +
                fishQuoted(option.help) + "\n";
    }
  }
  return script;
}

// A row per line.
string blenderOptionsText() {
  const Json options = blenderOptions();
  string text = "{\"panel\": [";
  for (const Json& row : options["panel"]) text += (&row == &options["panel"].front() ? "\n  " : ",\n  ") + row.dump();
  return text + "],\n \"refused\": " + options["refused"].dump() + "}\n";
}

}  // namespace

string docsText(string_view what, std::span<const CommandSpec> commands) {
  if (what == "man") return manPage(commands);
  if (what == "bash") return bashCompletion(commands);
  if (what == "zsh") return zshCompletion(commands);
  if (what == "fish") return fishCompletion(commands);
  if (what == "scene-keys") return sceneReference();
  if (what == "manifest-schema") return manifestSchema().dump(2) + "\n";
  if (what == "recipe-schema") return recipeSchema().dump(2) + "\n";
  if (what == "blender-options") return blenderOptionsText();
  throw UsageError("print-docs: one of " + string(kDocs) + " is needed" + (what.empty() ? "" : ", not '" + string(what) + "'"));
}

}  // namespace cloudbake
