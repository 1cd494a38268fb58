#include "hal/service/service_manager.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <cstring>

namespace cargobay::hal {
namespace {

std::string_view told_by(const char* name) {
  const char* const value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): only read
  return value == nullptr ? std::string_view{} : std::string_view{value};
}

std::optional<long long> whole_number(std::string_view text) {
  long long value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// A path, or @ and the name of an abstract socket.
bool is_socket_address(std::string_view text) {
  return text.size() > 1 && text.size() < sizeof(sockaddr_un::sun_path) &&
         (text[0] == '/' || text[0] == '@');
}

}  // namespace

ServiceManager::ServiceManager() {
  const std::string_view address = told_by("NOTIFY_SOCKET");
  if (!is_socket_address(address)) return;
  socket_ = Descriptor{socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)};
  address_ = address;
  // Of a parent that passed its environment on, it is not meant for this process.
  const auto process = whole_number(told_by("WATCHDOG_PID"));
  const auto microseconds = whole_number(told_by("WATCHDOG_USEC"));
  if (microseconds && *microseconds > 0 && process.value_or(getpid()) == getpid())
    interval_ = std::chrono::microseconds{*microseconds};
}

void ServiceManager::ready() { send("READY=1"); }

void ServiceManager::status(std::string_view text) {
  std::string line = "STATUS=" + std::string{text};
  std::replace_if(
      line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
  send(line);
}

void ServiceManager::stopping() { send("STOPPING=1"); }

void ServiceManager::alive(rt::TimePoint now) {
  if (!interval_ || (last_sign_ && now - *last_sign_ < *interval_ / 2)) return;
  last_sign_ = now;
  send("WATCHDOG=1");
}

void ServiceManager::send(const std::string& line) {
  if (address_.empty()) return;
  sockaddr_un to{};
  to.sun_family = AF_UNIX;
  std::memcpy(to.sun_path, address_.data(), address_.size());
  if (to.sun_path[0] == '@') to.sun_path[0] = '\0';
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + address_.size());
  // Whether it arrived is the manager's concern: nothing here depends on it.
  (void)sendto(socket_.number(), line.data(), line.size(), MSG_NOSIGNAL,
               reinterpret_cast<const sockaddr*>(&to), size);
}

}  // namespace cargobay::hal
