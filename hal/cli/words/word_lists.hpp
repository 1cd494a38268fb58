// The words that values of options and operands may be, from the tables that check them.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace cargobay::cli {

struct Word {
  std::string text{};
  std::string meaning{};  // on one line; may be empty
};

struct WordList {
  std::vector<Word> words{};
  bool files = false;         // files, too
  bool comma_listed = false;  // may be repeated, with commas between
};

// Of the option without its dashes; `choices` is what its help says that it takes: "TEXT:{a,b}".
WordList words_of_option(std::string_view option, std::string_view choices);

// After `operands`, of the subcommand of that name: commands of the robot and their arguments for
// send and encode, files for those that read some.
WordList words_of_operand(std::string_view subcommand, std::span<const std::string> operands);

}  // namespace cargobay::cli
