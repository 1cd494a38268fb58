// The robot's end of a pseudo-terminal: to any program that opens the other end it is a serial
// port. It survives clients that come and go, knows the rate they set, and keeps no bytes for a
// port that no client has open.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "hal/result.hpp"
#include "hal/sim/line/pty_clients.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal::sim {

class PtyPort {
 public:
  // A new pseudo-terminal, raw and at that rate before any client can open it. `link`, unless
  // empty, becomes a symbolic link to it. Only one thing that may be there already is replaced: our
  // user's link to a pseudo-terminal that is gone, as a killed virtual Create leaves it. (One whose
  // owner or rights were changed after the link was made is taken for gone.)
  static Result<std::unique_ptr<PtyPort>> open(const std::string& link, std::uint32_t baud);
  // Removes the link, if it is still ours.
  ~PtyPort();
  PtyPort(const PtyPort&) = delete;
  PtyPort& operator=(const PtyPort&) = delete;

  // What a client opens: the link if there is one.
  const std::string& path() const { return link_.empty() ? device_path_ : link_; }
  const std::string& device_path() const { return device_path_; }

  // For a poll: readable when a client has sent something; -1 while no client can have.
  int descriptor() const { return clients_.pollable_master(); }
  // Readable when the clients should be updated; -1 if the kernel refused to watch.
  int watch_descriptor() const { return clients_.watch_descriptor(); }
  const PtyClients& clients() const { return clients_; }
  void update_clients(rt::TimePoint now) { clients_.update(now); }
  // Whether the descriptors are still the pseudo-terminal's. A program that runs a virtual Create
  // and closes descriptors it does not know takes them away, and its own files get their numbers.
  bool intact() const;
  // Gives them up: they are no longer read, written or closed.
  void disown();

  // None of these blocks. They return what could be moved now.
  std::size_t read(std::span<std::uint8_t> bytes, rt::TimePoint now);
  std::size_t write(std::span<const std::uint8_t> bytes);
  // The rate that the client set. A rate of 0 (hang up), or an unreadable one, leaves the last.
  std::uint32_t host_baud();

 private:
  PtyPort(int master, std::string device_path, std::uint32_t baud)
      : master_{master},
        clients_{master, device_path},
        host_baud_{baud},
        device_path_{std::move(device_path)} {}
  Result<void> make_link(const std::string& link);

  int master_;
  PtyClients clients_;
  std::uint32_t host_baud_;
  std::string device_path_;
  std::string link_{};
};

}  // namespace cargobay::hal::sim
