// What may stand next on a command line: for the completion of shells (docs/completion).
#pragma once

#include <span>
#include <string>

namespace CLI {
class App;
}

namespace cargobay::cli {

// `cargobay complete WORD...` prints completions(). Not in --help: it is for shells.
inline constexpr const char* kCompleteWord = "complete";
// `cargobay help drive` is `cargobay drive --help`.
inline constexpr const char* kHelpWord = "help";
// The line that says: names of files, too.
inline constexpr const char* kFilesLine = ":files";

// `words` are those after the program's name up to the one to be completed, which may be empty. A
// line for each word that begins as the last one does: the word, a tab and what it means. Options,
// subcommands and values come from the options and tables of the command itself. A value that is
// joined to its option comes with it (`--remainder=lost`), one in a list with those before it.
std::string completions(const CLI::App& app, std::span<const char* const> words);

}  // namespace cargobay::cli
