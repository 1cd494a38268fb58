// The robot's end of a pseudo-terminal: to whoever opens the other end it is a serial port. It
// lives through clients that come and go, knows the rate they set, and keeps no bytes for a port
// that nobody has open.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "hal/result.hpp"
#include "hal/sim/line/pty_clients.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal::sim {

class PtyPort {
 public:
  // A new pseudo-terminal, raw and at that rate before anybody can open it. `link`, unless empty,
  // becomes a symbolic link to it. Of what is there already one thing is replaced: our user's link
  // to a pseudo-terminal that is gone, as a virtual Create leaves it that is killed.
  static Result<std::unique_ptr<PtyPort>> open(const std::string& link, std::uint32_t baud);
  // Removes the link, if it is still ours.
  ~PtyPort();
  PtyPort(const PtyPort&) = delete;
  PtyPort& operator=(const PtyPort&) = delete;

  // What a client opens: the link where there is one.
  const std::string& path() const { return link_.empty() ? device_path_ : link_; }
  const std::string& device_path() const { return device_path_; }

  // For a poll: readable when a client has sent something; -1 while none can have.
  int descriptor() const { return clients_.pollable_master(); }
  // Readable when to update the clients; -1 where the kernel would not watch.
  int watch_descriptor() const { return clients_.watch_descriptor(); }
  const PtyClients& clients() const { return clients_; }
  void update_clients(rt::TimePoint now) { clients_.update(now); }
  // Whether the descriptors are still the pseudo-terminal's: a program that closes what it does not
  // know takes them from a virtual Create within it, and its own files get their numbers.
  bool intact() const;
  // Gives them up: nothing of them is read, written or closed any more.
  void disown();

  // None of these blocks. What cannot be moved now is not counted.
  std::size_t read(std::span<std::uint8_t> bytes, rt::TimePoint now);
  std::size_t write(std::span<const std::uint8_t> bytes);
  // The rate the client set. A rate of 0 (hang up) and one that cannot be read leave the last.
  std::uint32_t host_baud();

 private:
  PtyPort(int master, std::string device_path, std::uint32_t baud)
      : master_{master},
        clients_{master, device_path},
        host_baud_{baud},
        device_path_{std::move(device_path)} {}
  std::optional<Failure> make_link(const std::string& link);

  int master_;
  PtyClients clients_;
  std::uint32_t host_baud_;
  std::string device_path_;
  std::string link_{};
};

}  // namespace cargobay::hal::sim
