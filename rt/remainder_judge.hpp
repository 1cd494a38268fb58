// Which kind of remainder a robot has, by its counts alone.
//
// The same speed is read in a window of many ticks, then tick by tick, then in a window again. If
// the remainder is carried, the readings tick by tick add up to what the windows say; if it is
// lost, each falls short by the fraction of a step that its tick left over. No model of the motors
// is asked: a speed that changes evenly cancels out between the two windows, and one that changes
// otherwise shows in their difference, by which the evidence shrinks.
//
// One thread; no allocation.
#pragma once

#include "rt/nonblocking.hpp"

namespace cargobay::rt {

class RemainderJudge {
 public:
  struct Counts {
    int distance = 0;  // mm
    int turn = 0;      // degrees
  };

  // The counters were read `ticks` after they were last read. `steady`: the robot is asked for the
  // same speed as before. Returns the evidence for `carried` over `lost` that this completes,
  // natural logarithm of the odds; 0 if none.
  double read(int ticks, const Counts& counts, bool steady = false) CARGOBAY_NONBLOCKING;

  // A reading was missed or is not to be believed: begins again.
  void doubt() CARGOBAY_NONBLOCKING {
    before_ = {};
    single_ = {};
  }

 private:
  // Successive readings together.
  struct Sum {
    int ticks = 0;
    Counts counts{};
    void add(int more_ticks, const Counts& more) CARGOBAY_NONBLOCKING;
  };
  static double judge(const Sum& before, const Sum& single, const Sum& after, int Counts::* axis)
      CARGOBAY_NONBLOCKING;

  Sum before_{};  // a window
  Sum single_{};  // readings of one tick each, behind it
};

}  // namespace cargobay::rt
