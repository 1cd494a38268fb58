#include "hal/cli/words/completion.hpp"

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "hal/cli/words/word_lists.hpp"

namespace cargobay::cli {
namespace {

// Its first sentence, on one line.
std::string first_sentence(std::string_view text) {
  std::string line{text};
  std::ranges::replace_if(line, [](char c) { return c == '\n' || c == '\t'; }, ' ');
  line.resize(std::min(line.size(), line.find(". ")));
  if (line.ends_with('.') || line.ends_with(':')) line.pop_back();
  return line;
}

bool takes_value(const CLI::Option& option) { return option.get_items_expected_min() > 0; }

const CLI::Option* find_option(const CLI::App& command, std::string_view word) {
  const std::string name{word.substr(0, word.find('='))};
  for (const CLI::Option* const option : command.get_options()) {
    if (option->nonpositional() && option->check_name(name)) return option;
  }
  return nullptr;
}

const CLI::App* find_subcommand(const CLI::App& command, std::string_view name) {
  for (const CLI::App* const each : command.get_subcommands([](const CLI::App*) { return true; })) {
    if (each->get_name() == name) return each;
  }
  return nullptr;
}

// Where the line has come to before its last word.
struct Place {
  const CLI::App* command = nullptr;
  std::vector<std::string> operands{};  // of the command
  const CLI::Option* option = nullptr;  // that waits for its value
};

Place place_after(const CLI::App& app, std::span<const char* const> words) {
  Place place{.command = &app};
  for (const std::string_view word : words) {
    if (std::exchange(place.option, nullptr) != nullptr) continue;
    if (word.starts_with('-') && word.size() > 1) {
      const CLI::Option* const option = find_option(*place.command, word);
      const bool joined = word.find('=') != std::string_view::npos;
      if (option != nullptr && takes_value(*option) && !joined) place.option = option;
    } else if (const CLI::App* const inner = find_subcommand(*place.command, word);
               inner != nullptr && place.operands.empty()) {
      place.command = inner;
    } else {
      place.operands.emplace_back(word);
    }
  }
  return place;
}

class Printer {
 public:
  // All words begin with `begun`.
  explicit Printer(std::string_view begun) : begun_{begun} {}

  void offer(std::string_view prefix, const Word& word) {
    const std::string whole = fmt::format("{}{}", prefix, word.text);
    if (whole.starts_with(begun_)) text_ += fmt::format("{}\t{}\n", whole, word.meaning);
  }
  // `before` is what the value is joined to.
  void offer(std::string_view before, const WordList& list) {
    std::string prefix{before};
    const std::size_t comma = begun_.rfind(',');
    if (list.comma_listed && comma != std::string_view::npos && comma >= before.size())
      prefix = begun_.substr(0, comma + 1);
    for (const Word& word : list.words) offer(prefix, word);
    if (list.files) text_ += fmt::format("{}\n", kFilesLine);
  }
  std::string text() && { return std::move(text_); }

 private:
  std::string_view begun_;
  std::string text_{};
};

WordList values_of(const CLI::Option& option) {
  const std::vector<std::string>& names = option.get_lnames();
  return words_of_option(names.empty() ? "" : names.front(), option.get_type_name());
}

void offer_options(const CLI::App& command, Printer& printer) {
  for (const CLI::Option* const option : command.get_options()) {
    for (const std::string& name : option->get_lnames())
      printer.offer("--", Word{name, first_sentence(option->get_description())});
    for (const std::string& name : option->get_snames())
      if (option->get_lnames().empty())
        printer.offer("-", Word{name, first_sentence(option->get_description())});
  }
}

}  // namespace

std::string completions(const CLI::App& app, std::span<const char* const> words) {
  if (words.size() > 1 && std::string_view{words.front()} == kHelpWord) words = words.subspan(1);
  if (words.empty()) return "";
  const std::string_view current = words.back();
  const Place place = place_after(app, words.first(words.size() - 1));
  Printer printer{current};
  const std::size_t equals = current.find('=');
  if (place.option != nullptr) {
    printer.offer("", values_of(*place.option));
  } else if (current.starts_with("--") && equals != std::string_view::npos) {
    const CLI::Option* const option = find_option(*place.command, current);
    if (option != nullptr) printer.offer(current.substr(0, equals + 1), values_of(*option));
  } else if (current.starts_with('-')) {
    offer_options(*place.command, printer);
  } else {
    if (place.operands.empty()) {
      for (const CLI::App* const each :
           place.command->get_subcommands([](const CLI::App*) { return true; }))
        printer.offer("", Word{each->get_name(), first_sentence(each->get_description())});
    }
    printer.offer("", words_of_operand(place.command->get_name(), place.operands));
  }
  return std::move(printer).text();
}

}  // namespace cargobay::cli
