// The descriptor of a port, kept out of the way of the program that the library lives in.
//
// Programs close descriptors that are not theirs (close_range() in code that makes daemons), open
// files that get the same numbers, start with standard input or output closed, and fork. So the
// number is a high one, which the kernel does not give out as the lowest that is free; what was
// opened is remembered, and can be compared; and a forked child closes its copy, so that neither
// the port nor its lock (flock(2) belongs to the open file, not to a process) outlives the parent.
#pragma once

#include <sys/types.h>

#include "rt/nonblocking.hpp"

namespace cargobay::hal {

class PortDescriptor {
 public:
  PortDescriptor() = default;
  // Takes over an open descriptor and gives it a high number, with close-on-exec; the old number is
  // closed. If the kernel refuses another number, it stays the same.
  static PortDescriptor adopt(int descriptor);
  // A second descriptor of the same open file, under a high number; none (-1) if that fails.
  static PortDescriptor duplicate(int descriptor);
  // Watches a descriptor that a library opened, keeps and closes: only compares it, and closes it
  // in a forked child.
  static PortDescriptor borrow(int descriptor);
  // Closes it, unless the number is no longer the port's.
  ~PortDescriptor();
  PortDescriptor(PortDescriptor&& other) noexcept;
  PortDescriptor& operator=(PortDescriptor&& other) noexcept;
  PortDescriptor(const PortDescriptor&) = delete;
  PortDescriptor& operator=(const PortDescriptor&) = delete;

  int number() const CARGOBAY_NONBLOCKING { return number_; }
  // Whether the number is still the port's. One system call.
  bool still_open() const noexcept;

 private:
  PortDescriptor(int number, bool owned);

  int number_ = -1;
  bool owned_ = true;
  dev_t device_ = 0;  // what was opened, by stat(2)
  ino_t inode_ = 0;
};

// While this lives, the numbers 0 to 2 are taken, by /dev/null if by nothing else: what a library
// opens meanwhile cannot become the standard output of a program started without one.
class StandardNumbersTaken {
 public:
  StandardNumbersTaken();
  ~StandardNumbersTaken();
  StandardNumbersTaken(const StandardNumbersTaken&) = delete;
  StandardNumbersTaken& operator=(const StandardNumbersTaken&) = delete;

 private:
  bool ours_[3] = {};  // NOLINT(cppcoreguidelines-avoid-c-arrays,modernize-avoid-c-arrays)
};

}  // namespace cargobay::hal
