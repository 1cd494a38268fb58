// The robot's end of a pseudo-terminal: to whoever opens the other end it is a serial port. It
// lives through clients that come and go, knows the rate they set, and keeps no bytes for a port
// that nobody has open.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "hal/result.hpp"

namespace cargobay::hal::sim {

class PtyPort {
 public:
  // A new pseudo-terminal, raw and at that rate before anybody can open it. `link`, unless empty,
  // becomes a symbolic link to it: one that is there already is replaced, anything else refused.
  static Result<std::unique_ptr<PtyPort>> open(const std::string& link, std::uint32_t baud);
  // Removes the link, if it is still ours.
  ~PtyPort();
  PtyPort(const PtyPort&) = delete;
  PtyPort& operator=(const PtyPort&) = delete;

  // What a client opens: the link where there is one.
  const std::string& path() const { return link_.empty() ? device_path_ : link_; }
  const std::string& device_path() const { return device_path_; }

  // Readable when a client has sent something.
  int descriptor() const { return master_; }
  // Readable when a client has come or gone; -1 where the kernel would not watch.
  int watch_descriptor() const { return watch_; }
  // Takes note of clients that came or went. When the last has gone, what it did not read is
  // dropped and its exclusive use ends, as on a serial port.
  void update_clients();
  bool has_client() const { return clients_ > 0 || watch_ < 0; }

  // None of these blocks. What cannot be moved now is not counted.
  std::size_t read(std::span<std::uint8_t> bytes);
  std::size_t write(std::span<const std::uint8_t> bytes);
  // The rate the client set. A rate of 0 (hang up) and one that cannot be read leave the last.
  std::uint32_t host_baud();

 private:
  PtyPort() = default;
  void last_client_gone();

  int master_ = -1;
  int slave_ = -1;  // held open: no client, no hang-up
  int watch_ = -1;
  int clients_ = 0;
  std::uint32_t host_baud_ = 0;
  std::string device_path_;
  std::string link_;
};

}  // namespace cargobay::hal::sim
