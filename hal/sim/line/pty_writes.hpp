// Whether anybody wrote to the other end of a pseudo-terminal: the kernel tells at once, long
// before the bytes come where it is busy.
#pragma once

#include <string>

namespace cargobay::hal::sim {

class PtyWrites {
 public:
  // `path` is that of the other end. Where the kernel would not watch it, there never was a write.
  explicit PtyWrites(const std::string& path);
  ~PtyWrites();
  PtyWrites(const PtyWrites&) = delete;
  PtyWrites& operator=(const PtyWrites&) = delete;

  // Since the last call. Does not block.
  [[nodiscard]] bool any();
  // The descriptor is no longer ours: it is not used or closed any more.
  void disown() { watch_ = -1; }

 private:
  int watch_;
};

}  // namespace cargobay::hal::sim
