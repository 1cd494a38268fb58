// The object of a virtual Create's handle, in either kind of time.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>

#include "hal/c/errors.hpp"
#include "hal/c/handles.hpp"
#include "hal/sim/line/server.hpp"
#include "hal/sim/line/virtual_link.hpp"
#include "hal/sim/robot/device.hpp"
#include "hal/sim/world/world.hpp"

struct cargobay_sim;  // the handle

namespace cargobay::c {

struct SimObject {
  explicit SimObject(hal::sim::World surroundings) : world{std::move(surroundings)} {}

  bool in_virtual_time() const { return device != nullptr; }
  // Runs `change` on the robot and its line in their present state.
  void with_cable(const std::function<void(hal::sim::Cable&)>& change);

  hal::sim::World world;                       // outlives what lives in it
  std::unique_ptr<hal::sim::Server> server{};  // in real time
  std::unique_ptr<hal::sim::Device> device{};  // in virtual time, with the link that moves it
  std::unique_ptr<hal::sim::VirtualLink> link{};
  std::atomic<bool> taken{false};  // a robot uses it
  std::mutex owner;                // of virtual time
};

using SimTable = HandleTable<SimObject, HandleKind::sim>;
SimTable& sims();
using SimUse = SimTable::Use;

// The error for a handle that is not an open virtual Create.
inline int bad_sim(const cargobay_sim* sim) noexcept { return bad_handle(sim, HandleKind::sim); }

}  // namespace cargobay::c
