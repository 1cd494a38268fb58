// Wrong on purpose: reads past the end of a heap block.
#include <cstdio>
#include <memory>

int main(int argc, char** /*argv*/) {
  const auto bytes = std::make_unique<char[]>(4);
  std::printf("%d\n", bytes[static_cast<unsigned>(argc) + 3U]);
}
