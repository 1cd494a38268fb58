#include "hal/sim/remote/control_connection.hpp"

#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <utility>

namespace cargobay::hal::sim {

namespace {

constexpr std::size_t kLongestLine = 1024;
constexpr rt::Duration kPatience = std::chrono::seconds{1};

}  // namespace

short ControlConnection::events() const { return unsent_.empty() ? POLLIN : POLLOUT; }

bool ControlConnection::serve(rt::TimePoint now, const Answers& answers) {
  if (!answer_all(now, answers)) return false;
  // A client with a pending answer is not read, so that its lines need no further room.
  const bool hears = unsent_.empty() && !ended_;
  if (hears && !(receive() && answer_all(now, answers))) return false;
  return !ended_ || !unsent_.empty();
}

// Answers as far as the client takes it. False if the client is gone, or its time is up.
bool ControlConnection::answer_all(rt::TimePoint now, const Answers& answers) {
  do {
    if (!flush(now)) return false;
  } while (unsent_.empty() && answer_next(answers));
  return true;
}

void ControlConnection::dismiss(std::string_view line) {
  unsent_ = std::string{line} + "\n";
  (void)flush({});  // a client without room for it did not ask for it
}

// Sends what it can. False if the client is gone, or its time is up.
bool ControlConnection::flush(rt::TimePoint now) {
  while (!unsent_.empty()) {
    const ssize_t count = send(socket_.number(), unsent_.data(), unsent_.size(), MSG_NOSIGNAL);
    if (count >= 0) {
      unsent_.erase(0, static_cast<std::size_t>(count));
      deadline_.reset();
      continue;
    }
    if (errno == EINTR) continue;
    if (errno != EAGAIN) return false;
    if (!deadline_) deadline_ = now + kPatience;
    return now < *deadline_;
  }
  deadline_.reset();
  return true;
}

// Reads once what is there. False if the connection is broken.
bool ControlConnection::receive() {
  std::array<char, 4096> bytes{};
  const ssize_t count = recv(socket_.number(), bytes.data(), bytes.size(), 0);
  if (count < 0) return errno == EAGAIN || errno == EINTR;
  ended_ = count == 0;
  received_.append(bytes.data(), static_cast<std::size_t>(count));
  return true;
}

// Answers the next whole line. False if there is none.
bool ControlConnection::answer_next(const Answers& answers) {
  const std::size_t length = received_.find('\n');
  const bool whole = length != std::string::npos;
  if (!whole && !ended_) {
    too_long_ = too_long_ || received_.size() > kLongestLine;
    if (too_long_) received_.clear();
    return false;
  }
  // An incomplete last line may say less than the client meant.
  if (!whole && received_.empty() && !too_long_) return false;
  const bool too_long =
      std::exchange(too_long_, false) || (whole ? length : received_.size()) > kLongestLine;
  if (too_long) {
    unsent_ = "error: the line is too long";
  } else {
    unsent_ = whole ? answers(std::string_view{received_}.substr(0, length))
                    : "error: the last line does not end; send a line feed after each";
  }
  unsent_ += '\n';
  received_.erase(0, whole ? length + 1 : received_.size());
  return true;
}

}  // namespace cargobay::hal::sim
