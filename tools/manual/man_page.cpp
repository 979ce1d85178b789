#include "tools/manual/man_page.h"

#include <cctype>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "lib/core/nearest_name.h"
#include "lib/image_io/atomic_file.h"

namespace spool::tools {
namespace {

struct ManPage {
  std::string file;  // "spool-evaluate.1"
  std::string text;  // roff, with the macros of man(7)
};

// Text that roff takes as it stands: no escapes, no requests, hyphens that can be copied.
std::string plain(std::string_view text) {
  std::string result;
  bool at_line_start = true;
  for (const char c : text) {
    if (at_line_start && (c == '.' || c == '\'')) result += "\\&";
    at_line_start = c == '\n';
    if (c == '\\')
      result += "\\e";
    else if (c == '-')
      result += "\\-";
    else
      result += c;
  }
  return result;
}

std::string upper(std::string text) {
  for (char& c : text)
    c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::string heading(const ProgramText& program, const std::string& page) {
  return fmt::format(".TH {} 1 \"\" \"{} {}\" \"Spool\"\n", upper(plain(page)), program.name,
                     program.version);
}

std::string synopsis(const ProgramText& program, const VerbText& verb) {
  std::string text =
      fmt::format(".SH SYNOPSIS\n.B {} {}\n[\\fIOPTIONS\\fR]", program.name, verb.name);
  for (const OptionText& argument : verb.arguments) {
    const std::string name =
        fmt::format("\\fI{}\\fR{}", plain(argument.names.front()), argument.several ? "..." : "");
    text += argument.required ? " " + name : " [" + name + "]";
  }
  for (const OptionText& option : verb.options) {
    if (option.required)
      text +=
          fmt::format(" \\fB{}\\fR \\fI{}\\fR", plain(option.names.front()), plain(option.value));
  }
  return text + "\n";
}

std::string entry(const OptionText& option) {
  std::string names;
  for (const std::string& name : option.names)
    names += (names.empty() ? "\\fB" : ", \\fB") + plain(name) + "\\fR";
  if (!option.value.empty()) names += " \\fI" + plain(option.value) + "\\fR";
  std::string help = option.help;
  if (!option.choices.empty())
    help += fmt::format("{}Known: {}.", help.empty() ? "" : "\n", fmt::join(option.choices, ", "));
  return ".TP\n" + names + "\n" + plain(help) + "\n";
}

// Examples keep their lines, which are as wide as those of --help; what stands before them is
// filled.
std::string notes(const std::string& text) {
  constexpr std::string_view kMark = "Examples:\n";
  const std::size_t examples = text.find(kMark);
  const std::string before = text.substr(0, examples);
  std::string result;
  if (!before.empty())
    result += ".SH NOTES\n" + plain(before) + (before.back() == '\n' ? "" : "\n");
  if (examples != std::string::npos) {
    result +=
        ".SH EXAMPLES\n.nf\n.in 0\n" + plain(text.substr(examples + kMark.size())) + "\n.fi\n";
  }
  return result;
}

ManPage page_of(const ProgramText& program, const VerbText& verb) {
  const std::string name = program.name + "-" + verb.name;
  std::string text = heading(program, name);
  text += fmt::format(".SH NAME\n{} \\- {}\n", plain(name), plain(verb.summary));
  text += synopsis(program, verb);
  if (!verb.arguments.empty()) text += ".SH ARGUMENTS\n";
  for (const OptionText& argument : verb.arguments)
    text += entry(argument);
  text += ".SH OPTIONS\n";
  for (const OptionText& option : verb.options)
    text += entry(option);
  text += notes(verb.notes);
  text += fmt::format(".SH SEE ALSO\n.BR {} (1)\n", program.name);
  return {name + ".1", text};
}

// spool(1), then spool-VERB(1) of each verb, in the program's order.
std::vector<ManPage> man_pages(const ProgramText& program) {
  std::string text = heading(program, program.name);
  text += fmt::format(".SH NAME\n{} \\- adaptive sampling and reconstruction on recorded samples\n",
                      program.name);
  text += fmt::format(".SH SYNOPSIS\n.B {}\n\\fIVERB\\fR [\\fIOPTIONS\\fR]\n", program.name);
  text += ".SH DESCRIPTION\n" + plain(program.summary) + "\n.SH VERBS\n";
  for (const VerbText& verb : program.verbs) {
    text += fmt::format(".TP\n.BR {}\\-{} (1)\n{}\n", program.name, plain(verb.name),
                        plain(verb.summary));
  }
  text += notes(program.notes);
  std::vector<ManPage> pages = {{program.name + ".1", text}};
  for (const VerbText& verb : program.verbs)
    pages.push_back(page_of(program, verb));
  return pages;
}

Result<void> write_pages(const std::vector<ManPage>& pages, const std::filesystem::path& folder,
                         bool overwrite) {
  std::error_code status;
  std::filesystem::create_directories(folder, status);
  for (const ManPage& page : pages)
    SPOOL_TRY(write_text_file(folder / page.file, page.text, overwrite));
  return {};
}

}  // namespace

Result<void> run_man(const ManOptions& options, const CommonOptions& common,
                     const ProgramText& program) {
  const std::vector<ManPage> pages = man_pages(program);
  if (!options.output.empty()) return write_pages(pages, options.output, common.force);
  if (options.verb.empty()) {
    print(pages.front().text);
    return {};
  }
  std::vector<std::string> names;
  for (std::size_t i = 0; i < program.verbs.size(); ++i) {
    names.push_back(program.verbs[i].name);
    if (names.back() != options.verb) continue;
    print(pages[i + 1].text);
    return {};
  }
  return fail(ErrorCode::kUsage, "{}", unknown_name("verb", options.verb, names));
}

}  // namespace spool::tools
