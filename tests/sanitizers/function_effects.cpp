// Wrong on purpose: must not compile in the rtsan preset.
#include <cstdlib>

void* cycle() noexcept [[clang::nonblocking]];

void* cycle() noexcept [[clang::nonblocking]] { return std::malloc(16); }

int main() { std::free(cycle()); }
