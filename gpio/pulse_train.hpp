// Signals on a line as data: levels and how long each lasts. They are played elsewhere.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <optional>
#include <span>

namespace cargobay::gpio {

enum class Level : unsigned char { low, high };

struct Pulse {
  Level level = Level::high;
  std::chrono::milliseconds duration{0};
  friend constexpr bool operator==(const Pulse&, const Pulse&) = default;
};

// The longest signal of this robot: three pulses, each low and high.
inline constexpr std::size_t kMostPulses = 6;

class PulseTrain {
 public:
  constexpr std::span<const Pulse> pulses() const { return {pulses_.data(), count_}; }
  // From the first edge to the end of the last pulse.
  constexpr std::chrono::milliseconds duration() const {
    std::chrono::milliseconds sum{0};
    for (const Pulse& pulse : pulses()) sum += pulse.duration;
    return sum;
  }

 private:
  friend constexpr std::optional<PulseTrain> brc_pulses(std::chrono::milliseconds low,
                                                        std::chrono::milliseconds high);
  friend constexpr PulseTrain power_toggle();

  constexpr void add(Level level, std::chrono::milliseconds duration) {
    pulses_[count_++] = {level, duration};
  }

  std::array<Pulse, kMostPulses> pulses_{};
  std::size_t count_ = 0;
};

// Baud Rate Change (OI p. 5): after it is switched on, the robot wants a pause of this length, then
// three low pulses, each of 50 to 500 ms; from then on it talks at 19200 baud.
inline constexpr std::chrono::milliseconds kBrcWaitAfterPowerOn{2000};
inline constexpr int kBrcPulses = 3;
inline constexpr std::chrono::milliseconds kBrcLeastWidth{50};
inline constexpr std::chrono::milliseconds kBrcMostWidth{500};
// What host software for this robot uses: the middle of what the manual allows.
inline constexpr std::chrono::milliseconds kBrcWidth{250};

// The three pulses; the line ends high, released. The high level between them must keep to the same
// limits as the low. Nothing if a width is outside them.
constexpr std::optional<PulseTrain> brc_pulses(std::chrono::milliseconds low = kBrcWidth,
                                               std::chrono::milliseconds high = kBrcWidth) {
  for (const std::chrono::milliseconds width : {low, high}) {
    if (width < kBrcLeastWidth || width > kBrcMostWidth) return std::nullopt;
  }
  PulseTrain train;
  for (int i = 0; i < kBrcPulses; ++i) {
    train.add(Level::low, low);
    train.add(Level::high, high);
  }
  return train;
}

// Power control toggle (OI p. 4): the low-to-high transition switches the robot on or off. The line
// ends low.
constexpr PulseTrain power_toggle() {
  using std::chrono::milliseconds;
  PulseTrain train;
  train.add(Level::low, milliseconds{500});
  train.add(Level::high, milliseconds{100});
  train.add(Level::low, milliseconds{0});
  return train;
}

}  // namespace cargobay::gpio
