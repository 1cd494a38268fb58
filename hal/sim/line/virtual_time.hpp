// The one clock of virtual links whose robots share a world. Whoever waits on one of them moves
// them all, event by event, and meanwhile the loops that run over the others make their passes,
// each at its instant. So what happens does not depend on which link is waited on. Its functions
// are in virtual_link.cpp.
#pragma once

#include <vector>

#include "rt/clock.hpp"

namespace cargobay::hal::sim {

class VirtualLink;

// One thread at a time, for the clock and all its links.
class VirtualTime {
 public:
  rt::Duration now() const { return now_; }

  // Called by the link: the newcomer is brought up to the present, and goes last among those for
  // whom something happens at the same instant. Allocates.
  void join(VirtualLink& link);
  void leave(VirtualLink& link);

  // Lets time pass to the next event of any link, or to `until`. Passes of one instant are made in
  // the order of joining: for `waiting`, a null pointer if none waits, its caller makes them.
  void step(const VirtualLink* waiting, rt::Duration until);
  // The same up to `until`, however many events there are before it.
  void advance_to(rt::Duration until);

 private:
  rt::Duration now_{0};
  std::vector<VirtualLink*> links_{};  // each leaves before it ends
};

}  // namespace cargobay::hal::sim
