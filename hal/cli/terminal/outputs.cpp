#include "hal/cli/terminal/outputs.hpp"

#include <unistd.h>

#include <algorithm>
#include <utility>

#include <fmt/core.h>

namespace cargobay::cli {

void Outputs::protect(std::string what, const std::string& path) {
  if (path.empty()) return;
  entries_.push_back({.what = std::move(what),
                      .place = path == "-" ? hal::place_of(STDIN_FILENO) : hal::place_of(path),
                      .input = true});
}

hal::Result<void> Outputs::open(std::string key, const std::string& path) {
  return open(std::move(key), path, Use::replace);
}

hal::Result<void> Outputs::open_to_edit(std::string key, const std::string& path) {
  return open(std::move(key), path, Use::edit);
}

hal::Result<void> Outputs::open(std::string key, const std::string& path, Use use) {
  if (path.empty()) return {};
  Entry entry{.key = key, .what = "the file of " + key, .use = use};
  if (path == "-") {
    entry.place = hal::place_of(STDOUT_FILENO);
  } else {
    auto file = hal::OutputFile::open(path);
    if (!file) return file.failure();
    entry.place = file->place();
    entry.file.emplace(std::move(*file));
    // After the file is replaced, printed output would still go to the old one, which has no name.
    const bool replaced = entry.place.folder.has_value();
    const bool printed = same_file(entry.place, hal::place_of(STDOUT_FILENO)) ||
                         same_file(entry.place, hal::place_of(STDERR_FILENO));
    if (replaced && printed) {
      return hal::Failure{
          fmt::format("{} names {}, where this command's own output goes; name another file, or - "
                      "for standard output",
                      key, path)};
    }
  }
  if (const Entry* const other = same_as(entry.place, use)) {
    return hal::Failure{fmt::format("{} names {}, {}; name another file", key,
                                    path == "-" ? "standard output" : path, other->what)};
  }
  entries_.push_back(std::move(entry));
  return {};
}

const Outputs::Entry* Outputs::same_as(const hal::FilePlace& place, Use use) const {
  const auto found = std::ranges::find_if(entries_, [&](const Entry& entry) {
    if (entry.input && use == Use::edit) return false;
    return hal::same_file(entry.place, place);
  });
  return found == entries_.end() ? nullptr : &*found;
}

Outputs::Entry* Outputs::find(std::string_view key) {
  const auto found =
      std::ranges::find_if(entries_, [key](const Entry& entry) { return entry.key == key; });
  return found == entries_.end() ? nullptr : &*found;
}

hal::Result<void> Outputs::write(std::string_view key, std::string_view text) {
  Entry* const entry = find(key);
  if (entry == nullptr) return {};
  if (!entry->file) {
    fmt::print("{}", text);
    return {};
  }
  if (auto done = entry->file->write(text); !done) return done;
  // An edited file existed before, and must not be lost if the power fails.
  if (entry->use == Use::edit) entry->file->sync();
  return entry->file->publish();
}

std::optional<hal::OutputFile> Outputs::take(std::string_view key) {
  Entry* const entry = find(key);
  if (entry == nullptr || !entry->file) return std::nullopt;
  return std::exchange(entry->file, std::nullopt);
}

}  // namespace cargobay::cli
