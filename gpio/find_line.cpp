#include "gpio/find_line.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <string_view>
#include <vector>

namespace cargobay::gpio {
namespace {

using Kind = LineError::Kind;

std::optional<unsigned> offset_of(std::string_view line) {
  unsigned offset = 0;
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), offset);
  if (error != std::errc{} || end != line.data() + line.size()) return std::nullopt;
  return offset;
}

bool denied(const ChipInfo& chip) { return chip.error == EACCES || chip.error == EPERM; }

// A link to a chip stands for the chip.
std::string resolved(const std::string& path) {
  std::error_code error;
  const std::filesystem::path real = std::filesystem::canonical(path, error);
  return error ? path : real.string();
}

std::string described(const ChipInfo& chip) { return chip.name + " [" + chip.label + "]"; }

// The chips that an address may mean; if a chip may not be opened, only its name is known.
std::vector<const ChipInfo*> meant(std::span<const ChipInfo> chips, const std::string& wanted) {
  const std::string path = wanted.starts_with('/') ? resolved(wanted) : "/dev/" + wanted;
  std::vector<const ChipInfo*> found;
  for (const ChipInfo& chip : chips) {
    const bool readable = chip.error == 0;
    if ((wanted.empty() && readable) || chip.path == path || (readable && chip.label == wanted))
      found.push_back(&chip);
  }
  return found;
}

const ChipInfo* first_denied(std::span<const ChipInfo> chips) {
  const auto* chip = std::find_if(chips.data(), chips.data() + chips.size(), denied);
  return chip == chips.data() + chips.size() ? nullptr : chip;
}

void forbid(const ChipInfo& chip, LineError& error) {
  error.kind = Kind::no_permission;
  error.path = chip.path;
  error.group = chip.group;
  error.error = chip.error;
}

// No chip was found. If one may not be opened, it may have been the one; otherwise there is none.
void no_chip(std::span<const ChipInfo> chips, LineError& error) {
  if (const ChipInfo* chip = first_denied(chips)) return forbid(*chip, error);
  error.kind = chips.empty() ? Kind::no_chips : Kind::no_such_chip;
  for (const ChipInfo& chip : chips) error.candidates.push_back(described(chip));
}

std::vector<FoundLine> matches(std::span<const ChipInfo* const> chips, const std::string& line) {
  std::vector<FoundLine> found;
  const std::optional<unsigned> offset = offset_of(line);
  for (const ChipInfo* chip : chips) {
    for (unsigned i = 0; i < chip->lines.size(); ++i) {
      if (offset == i || (!offset && !line.empty() && chip->lines[i].name == line))
        found.push_back({.chip_path = chip->path, .offset = i});
    }
  }
  return found;
}

const ChipInfo* chip_at(std::span<const ChipInfo> chips, const std::string& path) {
  for (const ChipInfo& chip : chips) {
    if (chip.path == path) return &chip;
  }
  return nullptr;
}

void make_busy(const ChipInfo& chip, const LineInfo& line, LineError& error) {
  error.kind = Kind::busy;
  error.path = chip.path;
  error.holder = line.consumer;
  error.error = EBUSY;
}

}  // namespace

std::optional<FoundLine> find_line(std::span<const ChipInfo> chips, const LineAddress& address,
                                   LineError& error) {
  error = {.address = address};
  const std::vector<const ChipInfo*> candidates = meant(chips, address.chip);
  if (candidates.empty()) {
    no_chip(chips, error);
    return std::nullopt;
  }
  if (!address.chip.empty() && candidates.size() > 1) {
    error.kind = Kind::ambiguous_chip;
    for (const ChipInfo* chip : candidates) error.candidates.push_back(chip->name);
    return std::nullopt;
  }
  if (!address.chip.empty() && candidates.front()->error != 0) {
    const ChipInfo& chip = *candidates.front();
    if (denied(chip)) {
      forbid(chip, error);
    } else {
      error.path = chip.path;
      error.error = chip.error;
    }
    return std::nullopt;
  }
  const std::vector<FoundLine> found = matches(candidates, address.line);
  if (found.size() != 1) {
    error.kind = found.empty() ? Kind::no_such_line : Kind::ambiguous_line;
    for (const FoundLine& line : found)
      error.candidates.push_back(line.chip_path + " line " + std::to_string(line.offset));
    if (found.empty()) {
      for (const ChipInfo* chip : candidates)
        error.candidates.push_back(described(*chip) + " with " +
                                   std::to_string(chip->lines.size()) + " lines");
    }
    return std::nullopt;
  }
  const ChipInfo& chip = *chip_at(chips, found.front().chip_path);
  const LineInfo& line = chip.lines[found.front().offset];
  if (line.used) {
    make_busy(chip, line, error);
    return std::nullopt;
  }
  return found.front();
}

LineError refused(std::span<const ChipInfo> chips, const LineAddress& address,
                  const FoundLine& found, int error) {
  LineError reason{.address = address, .path = found.chip_path, .error = error};
  const ChipInfo* chip = chip_at(chips, found.chip_path);
  if (error == EBUSY && chip != nullptr) {
    make_busy(*chip, chip->lines[found.offset], reason);
  } else if (error == EACCES || error == EPERM) {
    reason.kind = Kind::no_permission;
    if (chip != nullptr) reason.group = chip->group;
  }
  return reason;
}

}  // namespace cargobay::gpio
