// Owns a file descriptor.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <utility>

namespace cargobay::hal {

class Descriptor {
 public:
  Descriptor() = default;
  // Takes what open() and the like returned: -1, with errno, for none. A number below 3 is replaced
  // by a higher one: a program that has closed its standard output may still print.
  explicit Descriptor(int number) : number_{number} {
    if (number < 0 || number > STDERR_FILENO) return;
    number_ = fcntl(number, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    close(number);
  }
  ~Descriptor() {
    if (number_ >= 0) close(number_);
  }
  Descriptor(Descriptor&& other) noexcept : number_{std::exchange(other.number_, -1)} {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }

  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int number() const { return number_; }  // -1 for none

 private:
  int number_ = -1;
};

}  // namespace cargobay::hal
