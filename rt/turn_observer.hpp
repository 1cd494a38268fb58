// How far a robot has turned that loses the remainder of each reading of its angle.
//
// Such a robot is read rarely, so what it turns in between must be foreseen, for seconds. What is
// not known of the difference of the wheels' gains acts all that time, in one sense: so it is a
// state beside the turn itself, and a reading that tells one tells the other, also of what was
// turned before. Nor is it known how the wheels take their commands: models stand side by side, for
// wheels that follow each mm/s, for those whose commands act in steps, as owners report, and for
// those that turn unevenly for another reason. The readings weigh them. docs/control.md derives it.
//
// All turns are those of the right wheel less the left one, in mm. One thread; no allocation.
#pragma once

#include <array>
#include <cstddef>

#include "rt/axis_filter.hpp"
#include "rt/nonblocking.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::rt {

class TurnObserver {
 public:
  struct Parameters {
    double step_mm = 4.5;   // one degree (above 0)
    double tick_s = 0.015;  // above 0
  };

  // What is known of the wheels before the first reading: by how much the right one's gain is
  // larger, and the standard deviation of that.
  struct Begin {
    double gain_difference = 0.0;
    double gain_difference_sd = 0.0;
  };
  // What the wheels are driven at in one tick: as wheels of gain 1 are, and the gain of both in the
  // mean, with its standard deviation.
  struct Drive {
    WheelSpeeds wheels{};
    double gain = 1.0;
    double gain_sd = 0.0;
  };

  explicit TurnObserver(const Parameters& parameters);

  // A robot that stands.
  void reset(const Begin& begin) CARGOBAY_NONBLOCKING;
  // It was not followed, and turns at this speed now. What it has turned so far stays.
  void resume(const Begin& begin, double speed_mm_s, double variance) CARGOBAY_NONBLOCKING;

  // One tick. `doubt` as AxisFilter has it.
  void step(const Drive& drive, const AxisFilter::Response& response,
            const AxisFilter::Doubt& doubt) CARGOBAY_NONBLOCKING;
  // The angle was read and said `count` degrees; or what it said is not known.
  void read(int count) CARGOBAY_NONBLOCKING;
  void read_unseen() CARGOBAY_NONBLOCKING;

  // Since reset().
  double turn_mm() const CARGOBAY_NONBLOCKING;
  // Of that, what has gathered since the last reading.
  double unread_mm() const CARGOBAY_NONBLOCKING;
  double speed_mm_s() const CARGOBAY_NONBLOCKING;
  // Of turn_mm(): when the angle was last read, and now. Of unread_mm().
  double settled_variance() const CARGOBAY_NONBLOCKING;
  double turn_variance() const CARGOBAY_NONBLOCKING;
  double unread_variance() const CARGOBAY_NONBLOCKING;

 private:
  static constexpr std::size_t kWay = 0;
  static constexpr std::size_t kSpeed = 1;
  static constexpr std::size_t kGains = 2;
  static constexpr std::size_t kDrift = 3;
  static constexpr std::size_t kStates = 4;
  // The way is that since the last reading; the drift is what the wheels turn for none of the other
  // reasons. What was settled by readings before has no part in how it goes on, but is known better
  // with each.
  struct Model {
    std::array<double, kStates> state{};
    std::array<std::array<double, kStates>, kStates> covariance{};  // upper triangle
    double settled_mm = 0.0;
    double settled_variance = 0.0;
    std::array<double, kStates> settled_with{};  // covariance with the states
    double keep = 0.0;                           // of the drift, from tick to tick
    double log_weight = 0.0;
    double weight = 1.0;
  };
  // What moves a model's states in one tick.
  struct Inputs {
    double straight_mm_s = 0.0;  // by which the gains act
    double turn_mm_s = 0.0;
    bool none = false;  // then nothing is disturbed either
  };
  static constexpr std::size_t kModels = 4;

  static Inputs inputs(const Drive& drive, double step_mm_s) CARGOBAY_NONBLOCKING;
  static void propagate(Model& model, const Inputs& inputs, const AxisFilter::Response& response)
      CARGOBAY_NONBLOCKING;
  double condition(Model& model, int count) const CARGOBAY_NONBLOCKING;
  static void settle(Model& model) CARGOBAY_NONBLOCKING;
  void weigh() CARGOBAY_NONBLOCKING;
  template <typename Value>
  double mean(const Value& value) const CARGOBAY_NONBLOCKING;

  Parameters parameters_;
  std::array<Model, kModels> models_{};
};

}  // namespace cargobay::rt
