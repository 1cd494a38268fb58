// What is wrong with a command line, and what was probably meant.
#pragma once

#include <optional>
#include <span>
#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace cargobay::cli {

// About the words after the program's name, before they are parsed: CLI11 would answer a subcommand
// that it does not know with the help of all. Nothing if the first is a subcommand or an option of
// the program itself, or is missing.
std::optional<std::string> wrong_first_word(const CLI::App& app,
                                            std::span<const char* const> words);

// About words that the parser left over for a subcommand that takes operands: those that look like
// options. Nothing if there are none.
std::optional<std::string> wrong_option(const CLI::App& app);

// About a failed parse.
std::string explain(const CLI::App& app, const CLI::ParseError& error);

}  // namespace cargobay::cli
