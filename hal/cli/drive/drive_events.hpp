// The events of a drive, as lines for people and as JSON for programs.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "hal/cycle/cycle_state.hpp"
#include "hal/sensing/events.hpp"

namespace cargobay::cli {

// "  12.345 s  a cliff ...", with a newline; the time is the robot's.
std::string line(const hal::Event& event);

// A JSON array. `states`: of the whole drive, in order. Each event carries the states of the ticks
// around it, except for lost frames: on a bad line those events are too many.
std::string json(std::span<const hal::Event> events, const std::vector<hal::CycleState>& states);

}  // namespace cargobay::cli
