// The result of a drive, as a table for people and as JSON for programs.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hal/cli/drive/drive_log.hpp"
#include "hal/cycle/cycle_state.hpp"
#include "hal/doctor/doctor.hpp"
#include "rt/clock.hpp"
#include "rt/histogram.hpp"
#include "rt/learnt_plant.hpp"
#include "rt/realtime.hpp"

namespace cargobay::cli {

struct DriveReport {
  std::string port{};
  std::string robot{};  // what it is
  std::uint32_t baud = 0;
  bool open_loop = false;
  rt::RemainderBelief remainder = rt::RemainderBelief::unknown;
  rt::RealtimeGrant grant{};
  std::int64_t ticks = 0;
  hal::FrameCounters frames{};
  hal::PhaseOverruns overruns{};
  std::uint64_t refused_controls = 0;
  std::span<const hal::Event> events{};  // borrowed
  std::uint64_t events_dropped = 0;
  const std::vector<hal::CycleState>* states = nullptr;  // of all ticks, borrowed
  DriveFigures figures{};
  const rt::Histogram* period_ns = nullptr;            // borrowed
  const rt::Histogram* frame_to_command_ns = nullptr;  // borrowed
  int reconnects = 0;                                  // how often the port came back
  rt::Duration without_link{0};                        // in total
  std::vector<hal::Finding> findings{};                // about the machine, before the drive
  std::optional<rt::LearntPlant> learnt{};             // of the wheels
  bool began_from_earlier = false;                     // from what an earlier drive learnt
  std::string learnt_file{};                           // that keeps it; empty: none
};

std::string name(rt::RemainderBelief belief);
std::string table(const DriveReport& report);
std::string json(const DriveReport& report);

}  // namespace cargobay::cli
