#include "hal/cli/drive/profile.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "hal/file/read_input.hpp"
#include "oi/dialect.hpp"
#include "oi/limits.hpp"

namespace cargobay::cli {
namespace {

using Piece = Profile::Piece;

constexpr double kSquareSideMm = 500.0;
// For each wheel: turning in place by a right angle.
constexpr double kQuarterTurnMm = oi::kCreate.wheel_base_mm * std::numbers::pi / 4.0;

rt::WheelSpeeds both(double speed_mm_s) { return {speed_mm_s, speed_mm_s}; }

std::vector<Piece> steps(double speed_mm_s) {
  constexpr double kStep = 2.0;  // seconds
  return {{kStep, both(0.25 * speed_mm_s)},
          {kStep, both(0.5 * speed_mm_s)},
          {kStep, both(speed_mm_s)},
          {kStep, both(0.5 * speed_mm_s)},
          {kStep, both(-0.5 * speed_mm_s)}};
}

std::vector<Piece> square(double speed_mm_s) {
  const double turn_mm_s = 0.5 * speed_mm_s;
  return {{kSquareSideMm / std::abs(speed_mm_s), both(speed_mm_s)},
          {kQuarterTurnMm / std::abs(turn_mm_s), {-std::abs(turn_mm_s), std::abs(turn_mm_s)}}};
}

hal::Failure bad_line(const std::string& path, int line, const std::string& what) {
  return {
      fmt::format("{} line {}: {}; a line is SECONDS LEFT_MM_S RIGHT_MM_S, such as: 2.5 200 150",
                  path, line, what)};
}

}  // namespace

Profile::Profile(std::vector<Piece> pieces) : pieces_{std::move(pieces)} {
  for (const Piece& piece : pieces_) period_s_ += piece.duration_s;
}

std::span<const std::string_view> Profile::names() {
  static constexpr std::array<std::string_view, 4> kNames{"straight", "steps", "square", "spin"};
  return kNames;
}

bool Profile::is_named(std::string_view name_or_file) {
  return std::ranges::find(names(), name_or_file) != names().end();
}

hal::Result<Profile> Profile::load(const std::string& name_or_file, double speed_mm_s) {
  constexpr double kWhile = 3600.0;
  if (name_or_file == "straight") return Profile{{{kWhile, both(speed_mm_s)}}};
  if (name_or_file == "spin") return Profile{{{kWhile, {-speed_mm_s, speed_mm_s}}}};
  if (name_or_file == "steps") return Profile{steps(speed_mm_s)};
  if (name_or_file == "square") {
    if (speed_mm_s == 0.0)
      return hal::Failure{"a square needs a speed; choose --speed from 1 to 500"};
    return Profile{square(speed_mm_s)};
  }
  return read(name_or_file);
}

hal::Result<Profile> Profile::read(const std::string& path) {
  const auto file = hal::read_input(path, {});
  if (!file) {
    return hal::Failure{
        fmt::format("cannot read the profile {}: {}, or one of straight, steps, square, spin", path,
                    file.failure().message)};
  }
  std::istringstream lines{*file};
  std::vector<Piece> pieces;
  std::string text;
  for (int line = 1; std::getline(lines, text); ++line) {
    std::istringstream words{text.substr(0, text.find('#'))};
    if ((words >> std::ws).eof()) continue;
    Piece piece;
    std::string rest;
    if (!(words >> piece.duration_s >> piece.speeds.left_mm_s >> piece.speeds.right_mm_s) ||
        words >> rest) {
      return bad_line(path, line, "not three numbers");
    }
    if (!(piece.duration_s > 0.0) || !std::isfinite(piece.duration_s))
      return bad_line(path, line, "the time must be above 0");
    constexpr double kMost = oi::kMaxWheelSpeed;
    if (!(std::abs(piece.speeds.left_mm_s) <= kMost) ||
        !(std::abs(piece.speeds.right_mm_s) <= kMost)) {
      return bad_line(path, line, "a speed is beyond the robot's -500 to 500 mm/s");
    }
    pieces.push_back(piece);
  }
  if (pieces.empty()) return bad_line(path, 1, "the profile is empty");
  return Profile{std::move(pieces)};
}

rt::WheelSpeeds Profile::at(double seconds) const CARGOBAY_NONBLOCKING {
  double left_s = std::fmod(seconds, period_s_);
  for (const Piece& piece : pieces_) {
    if (left_s < piece.duration_s) return piece.speeds;
    left_s -= piece.duration_s;
  }
  return pieces_.back().speeds;
}

}  // namespace cargobay::cli
