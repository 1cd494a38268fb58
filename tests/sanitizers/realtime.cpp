// Wrong on purpose: allocates in a function that must not wait, hidden from the compiler by a
// pointer.
#include <cstdio>
#include <cstdlib>

namespace {

void* (*volatile allocate)(std::size_t) = std::malloc;

void* cycle() noexcept [[clang::nonblocking]] {
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wfunction-effects"  // the run-time check is under test here
  return allocate(16);
#pragma clang diagnostic pop
}

}  // namespace

int main() {
  void* memory = cycle();
  std::printf("%d\n", memory != nullptr);
  std::free(memory);
}
