// Whether any process has the other end of a pseudo-terminal open. The kernel knows, but says so
// only while we do not have it open ourselves, so we let go of it to look. Opens and closes are
// only hints when to look; they are not counted.
#pragma once

#include <string>
#include <system_error>
#include <utility>

#include "rt/clock.hpp"

namespace cargobay::hal::sim {

class PtyClients {
 public:
  // For the pseudo-terminal with that master, whose other end is at `path`. The master outlives
  // this.
  PtyClients(int master, std::string path) : master_{master}, path_{std::move(path)} {}
  ~PtyClients();
  PtyClients(const PtyClients&) = delete;
  PtyClients& operator=(const PtyClients&) = delete;

  // Opens our own descriptor of the other end. We hold it to end the exclusive use of
  // a client that died: by then no process may open the port, not even ours.
  [[nodiscard]] std::error_code open();
  int own() const { return own_; }  // -1 while it could not be opened
  // Readable when update() should be called; -1 if the kernel refused to watch.
  int watch_descriptor() const { return watch_; }
  // The master, if polling it for input can wait: a master whose other end is not open anywhere,
  // not even here, would report that immediately, for ever.
  int pollable_master() const { return own_ >= 0 || present_ ? master_ : -1; }

  // Looks if it is time to. When the last client has gone, what it did not read is dropped and its
  // exclusive use ends, as on a serial port.
  void update(rt::TimePoint now);
  // The latest time for the next update().
  rt::TimePoint next_update() const { return hinted_ ? settled_at_ : look_again_at_; }
  // Bytes have come from a client, so there is one.
  void heard(rt::TimePoint now);
  bool present() const { return present_; }
  // The descriptors are no longer ours: none of them is used or closed from now on.
  void disown() { own_ = watch_ = master_ = -1; }

 private:
  struct Hints {
    bool opened = false;
    bool closed = false;
  };
  Hints hints() const;
  void hint(rt::TimePoint now);
  void note_arrival(rt::TimePoint now);
  void reopen();
  bool look();

  int master_;
  std::string path_;
  int own_ = -1;
  int watch_ = -1;
  bool present_ = false;
  bool hinted_ = false;  // look as soon as things have settled
  rt::TimePoint hinted_at_{};
  rt::TimePoint settled_at_{};
  rt::TimePoint look_again_at_{};
};

}  // namespace cargobay::hal::sim
