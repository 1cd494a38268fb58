#include "hal/service/journal.hpp"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <cstring>

namespace cargobay::hal {
namespace {

// systemd names the file that it opened as standard error: it may be redirected by now.
bool is_standard_error() {
  const char* const named = std::getenv("JOURNAL_STREAM");  // NOLINT(concurrency-mt-unsafe): read
  struct stat file{};
  if (named == nullptr || fstat(STDERR_FILENO, &file) != 0) return false;
  return std::to_string(file.st_dev) + ":" + std::to_string(file.st_ino) == named;
}

// A value of more than one line comes with its size.
void append(std::string& datagram, std::string_view name, std::string_view value) {
  datagram += name;
  if (value.find('\n') == std::string_view::npos) {
    datagram += '=';
  } else {
    datagram += '\n';
    for (unsigned shift = 0; shift < 64; shift += 8)  // the lowest byte first
      datagram += static_cast<char>((std::uint64_t{value.size()} >> shift) & 0xffU);
  }
  datagram += value;
  datagram += '\n';
}

}  // namespace

Journal::Journal(const char* socket) : path_{socket} {
  if (std::strlen(path_) >= sizeof(sockaddr_un::sun_path) || !is_standard_error()) return;
  socket_ = Descriptor{::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)};
}

bool Journal::tell(Priority priority, std::string_view message,
                   std::span<const Field> fields) const {
  if (socket_.number() < 0) return false;
  std::string datagram;
  append(datagram, "PRIORITY", std::to_string(static_cast<int>(priority)));
  append(datagram, "SYSLOG_IDENTIFIER", "cargobay");
  append(datagram, "MESSAGE", message);
  for (const Field& field : fields) append(datagram, field.name, field.value);
  sockaddr_un to{};
  to.sun_family = AF_UNIX;
  std::memcpy(to.sun_path, path_, std::strlen(path_));
  const ssize_t sent = sendto(socket_.number(), datagram.data(), datagram.size(), MSG_NOSIGNAL,
                              reinterpret_cast<const sockaddr*>(&to), sizeof to);
  return sent == static_cast<ssize_t>(datagram.size());
}

}  // namespace cargobay::hal
