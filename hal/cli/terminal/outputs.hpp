// The files that one command was told to write, beside those that it reads.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/file/output_file.hpp"
#include "hal/result.hpp"

namespace cargobay::cli {

// Opens them all before the command does anything else, and refuses what would destroy something:
// two names of one file, a file that is read, a port (hal/file/output_file.hpp has the whole rule).
// An empty path, an option that was not given, is nothing to it.
class Outputs {
 public:
  // A file that none of them may be; `what` is its name in messages: "the configuration". "-" is
  // standard input.
  void protect(std::string what, const std::string& path);
  // "-" is standard output. `key` is the option, as write() and take() have it.
  [[nodiscard]] std::optional<hal::Failure> open(std::string key, const std::string& path);
  // A file that is read and then written: it may be among the protected ones.
  [[nodiscard]] std::optional<hal::Failure> open_to_edit(std::string key, const std::string& path);

  // Whole or not at all, where it was opened.
  [[nodiscard]] std::optional<hal::Failure> write(std::string_view key, std::string_view text);
  // For what is written little by little. Nothing where it was not opened.
  std::optional<hal::OutputFile> take(std::string_view key);

 private:
  enum class Use : std::uint8_t { replace, edit };
  struct Entry {
    std::string key{};
    std::string what{};
    hal::FilePlace place{};
    bool input = false;
    Use use = Use::replace;
    std::optional<hal::OutputFile> file{};  // none for standard output
  };
  std::optional<hal::Failure> open(std::string key, const std::string& path, Use use);
  const Entry* same_as(const hal::FilePlace& place, Use use) const;
  Entry* find(std::string_view key);

  std::vector<Entry> entries_{};
};

}  // namespace cargobay::cli
