// The events of a robot, numbered, for any number of readers: each says which it has seen.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "hal/sensing/events.hpp"
#include "rt/mailbox.hpp"
#include "rt/newest_ring.hpp"
#include "rt/nonblocking.hpp"

namespace cargobay::hal {

// Keeps the newest kMostEvents and, beyond those, the newest of each kind: however much has
// happened since, the last loss of the mode is there. No allocation.
class EventLog {
 public:
  struct Entry {
    std::int64_t sequence = 0;
    Event event{};
  };

  // From any thread, but each kind of event from one thread only. Lock-free.
  void put(const Event& event) CARGOBAY_NONBLOCKING {
    const std::int64_t sequence = newest_.put(event);
    newest_of_kind_[static_cast<std::size_t>(event.what)].put(
        {.sequence = sequence, .event = event});
  }

  // From any thread: the first after `sequence` that is still there. Lock-free.
  std::optional<Entry> next(std::int64_t sequence) const CARGOBAY_NONBLOCKING {
    std::optional<Entry> first;
    if (const auto entry = newest_.next(sequence))
      first = Entry{.sequence = entry->number, .event = entry->value};
    // An event that the ring still has in front of its oldest is not older than that.
    const std::int64_t in_ring = newest_.last() - static_cast<std::int64_t>(kMostEvents);
    if (sequence >= in_ring) return first;
    for (const auto& kept : newest_of_kind_) {
      const std::optional<Entry> entry = kept.get();
      if (!entry || entry->sequence <= sequence) continue;
      if (!first || entry->sequence < first->sequence) first = entry;
    }
    return first;
  }

  // The newest sequence number; 0: nothing has happened yet.
  std::int64_t last() const CARGOBAY_NONBLOCKING { return newest_.last(); }

 private:
  rt::NewestRing<Event, kMostEvents> newest_{};
  std::array<rt::Mailbox<Entry>, kEventKinds> newest_of_kind_{};
};

}  // namespace cargobay::hal
