// What a robot's drive begins from, and what becomes of what it learns.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <utility>

#include "hal/learnt/learnt_place.hpp"
#include "rt/clock.hpp"
#include "rt/learnt_plant.hpp"

namespace cargobay::hal {

// Never fails: without a file, or with one that cannot be read or written, the drive begins from
// nothing or keeps nothing, and remark() says so; a file of another kind stays. One thread at a
// time, none of them real-time; allocates, and blocks for the disk.
class LearntKeeper {
 public:
  explicit LearntKeeper(LearntPlace place) : place_{std::move(place)} {}

  // Call once. What an earlier drive learnt; nothing if there is nothing to begin from.
  std::optional<rt::LearntPlant> begin();

  // What the next drive should begin from, if this one has learnt enough (worth_keeping()): a kind
  // of remainder that it has not found out is the former one.
  std::optional<rt::LearntPlant> result(const std::optional<rt::LearntPlant>& learnt) const;

  // Writes the file if kPeriod has passed since this was first called, or since it was written.
  void now_and_then(const std::optional<rt::LearntPlant>& learnt, rt::TimePoint now);
  // Writes it at the end of a drive.
  void keep(const std::optional<rt::LearntPlant>& learnt);
  static constexpr rt::Duration kPeriod = std::chrono::minutes{1};

  // One line: why the file could not be used or written; empty if all went well.
  const std::string& remark() const { return remark_; }
  const LearntPlace& place() const { return place_; }

 private:
  LearntPlace place_;
  std::optional<rt::LearntPlant> former_{};
  bool is_anothers_ = false;  // the file: it is not written
  std::optional<rt::TimePoint> written_{};
  std::string remark_{};
};

}  // namespace cargobay::hal
