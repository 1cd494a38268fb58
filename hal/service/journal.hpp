// The journal of systemd, if standard error goes there: a line with fields, by which it can be
// searched: `journalctl CARGOBAY_EVENT=lost`. Its protocol: one datagram to a socket
// (https://systemd.io/JOURNAL_NATIVE_PROTOCOL).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "hal/file/descriptor.hpp"

namespace cargobay::hal {

// Any thread, one at a time. Allocates.
class Journal {
 public:
  static constexpr const char* kSocket = "/run/systemd/journal/socket";

  // As in syslog(3).
  enum class Priority : std::uint8_t { error = 3, warning = 4, notice = 5, info = 6 };
  struct Field {
    std::string_view name;  // capital letters, digits and underscores, a letter first
    std::string value{};    // any bytes
  };

  // Of this process, or one that takes nothing if standard error goes elsewhere. Reads the
  // environment. `socket` is where it listens; it outlives this.
  explicit Journal(const char* socket = kSocket);

  bool is_there() const { return socket_.number() >= 0; }
  // Whether the journal has it. If not, nothing of it is kept. Does not block.
  [[nodiscard]] bool tell(Priority priority, std::string_view message,
                          std::span<const Field> fields) const;

 private:
  Descriptor socket_{};
  const char* path_;
};

}  // namespace cargobay::hal
