// What there is to tell about a robot and its virtual Create: turned into messages when somebody
// listens.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "hal/feed/feed_tap.hpp"
#include "hal/feed/message/messages.hpp"
#include "hal/sim/line/server.hpp"
#include "hal/sim/world/world.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal {

class Robot;

// What a feed is about; all of it outlives the feed, and what is not there is null.
struct FeedSubjects {
  FeedTap* tap = nullptr;
  sim::Server* create = nullptr;
  const sim::World* world = nullptr;
  double wheel_base_mm = 0.0;
};

// Where messages go.
struct FeedOutlet {
  // A message of that type, to be filled.
  std::function<JsonObject(FeedType type)> begin{};
  std::function<void(FeedType type, JsonObject message)> tell{};
  // So many were overwritten before this thread came to them; empty: nobody is waiting for them.
  std::function<void(FeedType type, std::uint64_t count)> lost{};
};

// One thread. Allocates; locks a virtual Create once a second and for each greeting.
class FeedReports {
 public:
  explicit FeedReports(const FeedSubjects& of) : of_{of} {}

  // For the statistics.
  struct Readers {
    std::size_t clients = 0;
    std::uint64_t missed = 0;
  };
  // What is new since the last call. `robot` is null while there is none.
  void collect(Robot* robot, const Readers& readers, rt::TimePoint now, const FeedOutlet& to);
  // For a reader that has just come: the newest of each type, events as far back as they are kept.
  void greet(Robot* robot, const Readers& readers, const FeedOutlet& to) const;
  // What is there now need not be collected: nobody has been listening.
  void skip();

 private:
  // The last that was told, by its number or time.
  struct Told {
    std::int64_t state = 0;
    std::int64_t event = 0;
    std::int64_t truth_ns = -1;
  };
  static void go_on_to(std::int64_t& told, std::int64_t number, FeedType type,
                       const FeedOutlet& to);
  void tell_states(Robot* robot, Told& told, const FeedOutlet& to) const;
  void tell_events(Told& told, const FeedOutlet& to) const;
  void tell_truth(Told& told, const FeedOutlet& to) const;
  void tell_second(Robot* robot, const Readers& readers, const FeedOutlet& to) const;

  FeedSubjects of_;
  Told told_{};
  rt::TimePoint next_second_{};
};

}  // namespace cargobay::hal
