// What to drive: wheel speeds over time, in pieces of constant speed.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hal/result.hpp"
#include "rt/nonblocking.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::cli {

class Profile {
 public:
  struct Piece {
    double duration_s = 0.0;  // above 0
    rt::WheelSpeeds speeds{};
  };

  // `straight`, `steps`, `square`, `spin`, or a file of lines `SECONDS LEFT_MM_S RIGHT_MM_S`. The
  // named ones use `speed_mm_s`.
  static hal::Result<Profile> load(const std::string& name_or_file, double speed_mm_s);

  static std::span<const std::string_view> names();
  // Whether it is one of those names, not a file.
  static bool is_named(std::string_view name_or_file);

  // Speeds at that time; the profile repeats endlessly. For the control thread.
  rt::WheelSpeeds at(double seconds) const CARGOBAY_NONBLOCKING;
  double period_s() const { return period_s_; }

 private:
  explicit Profile(std::vector<Piece> pieces);
  static hal::Result<Profile> read(const std::string& path);

  std::vector<Piece> pieces_;  // at least one
  double period_s_ = 0.0;
};

}  // namespace cargobay::cli
