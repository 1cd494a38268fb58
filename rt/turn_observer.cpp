#include "rt/turn_observer.hpp"

#include <algorithm>
#include <cmath>

#include "rt/truncated_normal.hpp"

namespace cargobay::rt {
namespace {

// How wheels take their commands, one against the other.
struct Kind {
  double step_mm_s;  // in which commands act; 0: none
  double drift_sd_mm_s;
  double drift_lag_s;
  double gains_drift;  // of their difference, standard deviation each tick
  double log_odds;     // before anything was read
};
constexpr std::array<Kind, 4> kKinds{{{0.0, 2.0, 0.15, 1e-5, 0.0},
                                      {8.5, 2.0, 0.15, 1e-5, -1.0},
                                      {28.5, 2.0, 0.15, 1e-5, -1.0},
                                      {0.0, 6.0, 0.3, 1e-3, -1.0}}};
constexpr double kLeastLogWeight = -8.0;   // a robot may become another
constexpr double kLeastLikelihood = 1e-4;  // no single reading may decide
constexpr double kCounterNoise = 0.2;      // mm
constexpr double kLeastDriveMmS = 0.1;     // mm/s

}  // namespace

TurnObserver::TurnObserver(const Parameters& parameters) : parameters_{parameters} { reset({}); }

void TurnObserver::reset(const Begin& begin) CARGOBAY_NONBLOCKING {
  models_ = {};
  resume(begin, 0.0, 0.0);
  // What was left of the last reading before.
  for (Model& model : models_) {
    model.covariance[kWay][kWay] = parameters_.step_mm * parameters_.step_mm / 3.0;
  }
}

void TurnObserver::resume(const Begin& begin, double speed_mm_s, double variance)
    CARGOBAY_NONBLOCKING {
  const double turned_mm = turn_mm();
  for (std::size_t i = 0; i < kModels; ++i) {
    const Kind& kind = kKinds[i];
    Model& model = models_[i];
    model = {.state = {0.0, speed_mm_s, begin.gain_difference, 0.0},
             .settled_mm = turned_mm,
             .keep = std::exp(-parameters_.tick_s / kind.drift_lag_s),
             .log_weight = kind.log_odds};
    model.covariance[kSpeed][kSpeed] = variance;
    model.covariance[kGains][kGains] = begin.gain_difference_sd * begin.gain_difference_sd;
    model.covariance[kDrift][kDrift] = kind.drift_sd_mm_s * kind.drift_sd_mm_s;
  }
  weigh();
}

// F x and F P F' written out, as AxisFilter has them.
void TurnObserver::propagate(Model& model, const Inputs& inputs,
                             const AxisFilter::Response& response) CARGOBAY_NONBLOCKING {
  const double way_by_speed = response.position_by_speed;
  const double way_by_drift = inputs.none ? 0.0 : response.position_by_input;
  const double way_by_gains = way_by_drift * inputs.straight_mm_s;
  const double keep = response.speed_by_speed;
  const double speed_by_drift = inputs.none ? 0.0 : response.speed_by_input;
  const double speed_by_gains = speed_by_drift * inputs.straight_mm_s;
  const auto to_way = [&](double way, double speed, double gains,
                          double drift) CARGOBAY_NONBLOCKING {
    return way + way_by_speed * speed + way_by_gains * gains + way_by_drift * drift;
  };
  const auto to_speed = [&](double speed, double gains, double drift) CARGOBAY_NONBLOCKING {
    return keep * speed + speed_by_gains * gains + speed_by_drift * drift;
  };
  auto& x = model.state;
  x[kWay] = to_way(x[kWay], x[kSpeed], x[kGains], x[kDrift]) + way_by_drift * inputs.turn_mm_s;
  x[kSpeed] = to_speed(x[kSpeed], x[kGains], x[kDrift]) + speed_by_drift * inputs.turn_mm_s;
  x[kDrift] *= model.keep;

  auto& b = model.settled_with;
  b[kWay] = to_way(b[kWay], b[kSpeed], b[kGains], b[kDrift]);
  b[kSpeed] = to_speed(b[kSpeed], b[kGains], b[kDrift]);
  b[kDrift] *= model.keep;

  auto& p = model.covariance;
  const double way_way = to_way(p[kWay][kWay], p[kWay][kSpeed], p[kWay][kGains], p[kWay][kDrift]);
  const double way_speed =
      to_way(p[kWay][kSpeed], p[kSpeed][kSpeed], p[kSpeed][kGains], p[kSpeed][kDrift]);
  const double way_gains =
      to_way(p[kWay][kGains], p[kSpeed][kGains], p[kGains][kGains], p[kGains][kDrift]);
  const double way_drift =
      to_way(p[kWay][kDrift], p[kSpeed][kDrift], p[kGains][kDrift], p[kDrift][kDrift]);
  const double speed_speed = to_speed(p[kSpeed][kSpeed], p[kSpeed][kGains], p[kSpeed][kDrift]);
  const double speed_gains = to_speed(p[kSpeed][kGains], p[kGains][kGains], p[kGains][kDrift]);
  const double speed_drift = to_speed(p[kSpeed][kDrift], p[kGains][kDrift], p[kDrift][kDrift]);
  p[kWay][kWay] = to_way(way_way, way_speed, way_gains, way_drift);
  p[kWay][kSpeed] = to_speed(way_speed, way_gains, way_drift);
  p[kWay][kGains] = way_gains;
  p[kWay][kDrift] = model.keep * way_drift;
  p[kSpeed][kSpeed] = to_speed(speed_speed, speed_gains, speed_drift);
  p[kSpeed][kGains] = speed_gains;
  p[kSpeed][kDrift] = model.keep * speed_drift;
  p[kGains][kDrift] *= model.keep;
  p[kDrift][kDrift] *= model.keep * model.keep;
}

// Where commands act in steps, the gain by which the robot goes as fast as it does is another.
TurnObserver::Inputs TurnObserver::inputs(const Drive& drive, double step_mm_s)
    CARGOBAY_NONBLOCKING {
  const WheelSpeeds& by = drive.wheels;
  const double sum_mm_s = std::abs(by.left_mm_s) + std::abs(by.right_mm_s);
  const bool none = std::max(std::abs(by.left_mm_s), std::abs(by.right_mm_s)) < kLeastDriveMmS;
  WheelSpeeds acts = by;
  double gain = drive.gain;
  if (step_mm_s > 0.0) {
    acts = {step_mm_s * std::round(by.left_mm_s / step_mm_s),
            step_mm_s * std::round(by.right_mm_s / step_mm_s)};
    const double acts_mm_s = std::abs(acts.left_mm_s) + std::abs(acts.right_mm_s);
    if (acts_mm_s > 0.0) gain *= sum_mm_s / acts_mm_s;
  }
  return {.straight_mm_s = (acts.left_mm_s + acts.right_mm_s) / 2.0,
          .turn_mm_s = gain * (acts.right_mm_s - acts.left_mm_s),
          .none = none};
}

void TurnObserver::step(const Drive& drive, const AxisFilter::Response& response,
                        const AxisFilter::Doubt& doubt) CARGOBAY_NONBLOCKING {
  const double by_gain = drive.gain_sd * (drive.wheels.right_mm_s - drive.wheels.left_mm_s);
  for (std::size_t i = 0; i < kModels; ++i) {
    const Kind& kind = kKinds[i];
    Model& model = models_[i];
    const Inputs driven = inputs(drive, kind.step_mm_s);
    propagate(model, driven, response);
    auto& p = model.covariance;
    if (!driven.none) {
      const double drift = kind.drift_sd_mm_s * kind.drift_sd_mm_s + by_gain * by_gain;
      p[kDrift][kDrift] += (1.0 - model.keep * model.keep) * drift;
      p[kGains][kGains] += kind.gains_drift * kind.gains_drift;
    }
    p[kSpeed][kSpeed] += doubt.speed_mm_s * doubt.speed_mm_s;
    p[kWay][kWay] += doubt.position_mm * doubt.position_mm;
  }
}

// Returns the probability that the model gave to the count.
double TurnObserver::condition(Model& model, int count) const CARGOBAY_NONBLOCKING {
  const double low = (count > 0 ? count : count - 1) * parameters_.step_mm;
  const double high = (count < 0 ? count : count + 1) * parameters_.step_mm;
  auto& p = model.covariance;
  const double variance = p[kWay][kWay] + kCounterNoise * kCounterNoise;
  const TruncatedNormal seen = truncate(model.state[kWay], variance, low, high);
  const double off = (seen.mean - model.state[kWay]) / variance;
  const double less = (variance - seen.variance) / (variance * variance);
  const std::array<double, kStates> by_way = p[kWay];
  const double settled_by_way = model.settled_with[kWay];
  for (std::size_t i = 0; i < kStates; ++i) {
    model.state[i] += by_way[i] * off;
    model.settled_with[i] -= settled_by_way * by_way[i] * less;
    for (std::size_t j = i; j < kStates; ++j) p[i][j] -= by_way[i] * by_way[j] * less;
  }
  model.settled_mm += settled_by_way * off;
  model.settled_variance -= settled_by_way * settled_by_way * less;
  return seen.probability;
}

// The next reading begins here.
void TurnObserver::settle(Model& model) CARGOBAY_NONBLOCKING {
  auto& p = model.covariance;
  model.settled_mm += model.state[kWay];
  model.settled_variance += 2.0 * model.settled_with[kWay] + p[kWay][kWay];
  for (std::size_t i = kSpeed; i < kStates; ++i) model.settled_with[i] += p[kWay][i];
  model.settled_with[kWay] = 0.0;
  model.state[kWay] = 0.0;
  p[kWay] = {};
}

void TurnObserver::weigh() CARGOBAY_NONBLOCKING {
  double most = models_[0].log_weight;
  for (const Model& model : models_) most = std::max(most, model.log_weight);
  double sum = 0.0;
  for (Model& model : models_) {
    model.log_weight = std::max(model.log_weight - most, kLeastLogWeight);
    model.weight = std::exp(model.log_weight);
    sum += model.weight;
  }
  for (Model& model : models_) model.weight /= sum;
}

void TurnObserver::read(int count) CARGOBAY_NONBLOCKING {
  for (Model& model : models_) {
    const double probability = condition(model, count);
    model.log_weight += std::log(std::max(probability, kLeastLikelihood));
    settle(model);
  }
  weigh();
}

void TurnObserver::read_unseen() CARGOBAY_NONBLOCKING {
  for (Model& model : models_) settle(model);
}

template <typename Value>
double TurnObserver::mean(const Value& value) const CARGOBAY_NONBLOCKING {
  double sum = 0.0;
  for (const Model& model : models_) sum += model.weight * value(model);
  return sum;
}

double TurnObserver::turn_mm() const CARGOBAY_NONBLOCKING {
  return mean([](const Model& model)
                  CARGOBAY_NONBLOCKING { return model.settled_mm + model.state[kWay]; });
}

double TurnObserver::unread_mm() const CARGOBAY_NONBLOCKING {
  return mean([](const Model& model) CARGOBAY_NONBLOCKING { return model.state[kWay]; });
}

double TurnObserver::speed_mm_s() const CARGOBAY_NONBLOCKING {
  return mean([](const Model& model) CARGOBAY_NONBLOCKING { return model.state[kSpeed]; });
}

double TurnObserver::settled_variance() const CARGOBAY_NONBLOCKING {
  const double settled_mm =
      mean([](const Model& model) CARGOBAY_NONBLOCKING { return model.settled_mm; });
  return mean([settled_mm](const Model& model) CARGOBAY_NONBLOCKING {
    const double off = model.settled_mm - settled_mm;
    return model.settled_variance + off * off;
  });
}

double TurnObserver::turn_variance() const CARGOBAY_NONBLOCKING {
  const double whole_mm = turn_mm();
  return mean([whole_mm](const Model& model) CARGOBAY_NONBLOCKING {
    const double off = model.settled_mm + model.state[kWay] - whole_mm;
    return model.settled_variance + 2.0 * model.settled_with[kWay] + model.covariance[kWay][kWay] +
           off * off;
  });
}

double TurnObserver::unread_variance() const CARGOBAY_NONBLOCKING {
  const double unread = unread_mm();
  return mean([unread](const Model& model) CARGOBAY_NONBLOCKING {
    const double off = model.state[kWay] - unread;
    return model.covariance[kWay][kWay] + off * off;
  });
}

}  // namespace cargobay::rt
