// Whether any process wrote to the other end of a pseudo-terminal: the kernel reports it at once,
// long before the bytes arrive on a busy machine.
#pragma once

#include <string>

namespace cargobay::hal::sim {

class PtyWrites {
 public:
  // `path` is that of the other end. If the kernel refuses to watch it, any() is always false.
  explicit PtyWrites(const std::string& path);
  ~PtyWrites();
  PtyWrites(const PtyWrites&) = delete;
  PtyWrites& operator=(const PtyWrites&) = delete;

  // Since the last call. Does not block.
  [[nodiscard]] bool any();
  // The descriptor is no longer ours: it is not used or closed from now on.
  void disown() { watch_ = -1; }

 private:
  int watch_;
};

}  // namespace cargobay::hal::sim
