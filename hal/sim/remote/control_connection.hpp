// One client of the control socket. Nothing here blocks: an answer waits until the client takes it,
// and so does the client's next line.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "hal/file/descriptor.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal::sim {

class ControlConnection {
 public:
  // The answer to a line; both without the newline.
  using Answers = std::function<std::string(std::string_view line)>;

  explicit ControlConnection(Descriptor socket) : socket_{std::move(socket)} {}

  int descriptor() const { return socket_.number(); }
  // What to poll for.
  short events() const;
  // When to drop a client that does not take its answer; nothing while no answer is pending.
  std::optional<rt::TimePoint> deadline() const { return deadline_; }

  // Reads at most once, and answers. False when it is over: the client is gone, or has not taken
  // its answer by the deadline.
  bool serve(rt::TimePoint now, const Answers& answers);
  // Sends a last line, as far as there is room for it.
  void dismiss(std::string_view line);

 private:
  bool answer_all(rt::TimePoint now, const Answers& answers);
  bool flush(rt::TimePoint now);
  bool answer_next(const Answers& answers);
  bool receive();

  Descriptor socket_;
  std::string received_{};  // not answered yet
  bool too_long_ = false;   // the current line is too long; its rest is skipped
  bool ended_ = false;      // the client sends no more
  std::string unsent_{};
  std::optional<rt::TimePoint> deadline_{};
};

}  // namespace cargobay::hal::sim
