// An event as JSON: in a feed, and in the reports of a drive.
#pragma once

#include <cstdint>
#include <string>

#include "hal/json_object.hpp"
#include "hal/sensing/events.hpp"

namespace cargobay::hal {

// Puts what the event has into `object`: `what`, `tick`, `time_s` of the robot, `text` for people,
// and what its kind adds. Allocates.
void put_event(JsonObject& object, const Event& event);

// Of the robot, since the first frame.
double robot_time_s(std::int64_t tick);

// `{"left":..,"right":..}`
JsonObject json_of(const rt::WheelSpeeds& speeds);
// An array of names.
std::string json_of(Hazards hazards);
std::string json_of(Bumps bumps);
std::string json_of(Limits limits);

}  // namespace cargobay::hal
