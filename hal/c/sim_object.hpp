// The object of a virtual Create's handle, in either kind of time.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>

#include "hal/c/errors.hpp"
#include "hal/c/handles.hpp"
#include "hal/sim/line/server.hpp"
#include "hal/sim/line/virtual_link.hpp"
#include "hal/sim/line/virtual_time.hpp"
#include "hal/sim/robot/device.hpp"
#include "hal/sim/world/bodies.hpp"
#include "hal/sim/world/world.hpp"

struct cargobay_sim;  // the handle

namespace cargobay::c {

struct SimObject;
using SimTable = HandleTable<SimObject, HandleKind::sim>;
SimTable& sims();
using SimUse = SimTable::Use;

// What virtual Creates that are beside each other have in common. It belongs to the first of them.
struct SimWorld {
  hal::sim::World world{};
  hal::sim::Bodies bodies{};
  bool in_virtual_time = false;
  hal::sim::VirtualTime time{};  // in virtual time
  std::timed_mutex owner;        // of virtual time
  std::atomic<int> guests{0};    // virtual Creates beside the first
};

struct SimObject {
  SimObject() = default;
  ~SimObject();
  SimObject(const SimObject&) = delete;
  SimObject& operator=(const SimObject&) = delete;

  SimWorld& world() { return first ? *first->own : *own; }
  bool in_virtual_time() const { return device != nullptr; }
  // Runs `change` on the robot and its line in their present state.
  void with_cable(const std::function<void(hal::sim::Cable&)>& change);

  SimUse first{};  // the one that it is beside; if none, `own` is there
  const cargobay_sim* first_handle = nullptr;
  std::unique_ptr<SimWorld> own{};             // outlives what lives in it
  std::optional<std::size_t> number{};         // among the bodies
  std::unique_ptr<hal::sim::Server> server{};  // in real time
  std::unique_ptr<hal::sim::Device> device{};  // in virtual time, with the link that moves it
  std::unique_ptr<hal::sim::VirtualLink> link{};
  std::atomic<bool> taken{false};  // a robot uses it
};

// The error for a handle that is not an open virtual Create.
inline int bad_sim(const cargobay_sim* sim) noexcept { return bad_handle(sim, HandleKind::sim); }
// The error if the owner of virtual time is another thread.
inline int moved_elsewhere() noexcept {
  return fail(
      CARGOBAY_E_THREAD,
      "another thread already moves the virtual time of this robot, or of one in its world; "
      "let one thread do it");
}

}  // namespace cargobay::c
