// Wrong on purpose: allocates where nothing may wait, hidden from the compiler behind a pointer.
#include <cstdio>
#include <cstdlib>

namespace {

void* (*volatile allocate)(std::size_t) = std::malloc;

void* cycle() noexcept [[clang::nonblocking]] {
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wfunction-effects"  // the run-time check is what is shown here
  return allocate(16);
#pragma clang diagnostic pop
}

}  // namespace

int main() {
  void* memory = cycle();
  std::printf("%d\n", memory != nullptr);
  std::free(memory);
}
