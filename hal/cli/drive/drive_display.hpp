// What a drive shows while it lasts: on a terminal the live picture of hal/cli/view/drive_view.hpp,
// elsewhere each event as it comes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "hal/cli/drive/drive_links.hpp"
#include "hal/cli/view/screen.hpp"
#include "hal/cycle/cycle_state.hpp"

namespace cargobay::cli {

class DriveDisplay {
 public:
  enum class Events : std::uint8_t { print, keep_quiet };
  // `links` outlives it.
  DriveDisplay(std::string what, double duration_s, const DriveLinks& links, Events events);

  // Takes the screen, if there is one, until end().
  void begin();
  // Call it now and then, with what the cycle has counted; draws, or prints new events.
  void show(const hal::FrameCounters& frames);
  // Gives the screen back, then prints the events that came meanwhile.
  void end();
  void print_events();

 private:
  std::string what_;
  double duration_s_;
  const DriveLinks& links_;
  Events use_;
  std::unique_ptr<Screen> screen_{};
  std::size_t printed_ = 0;
};

}  // namespace cargobay::cli
