// Wrong on purpose: two threads, one counter, no order.
#include <cstdio>
#include <thread>

int main() {
  int counter = 0;
  const auto count = [&counter] {
    for (int i = 0; i < 100000; ++i) ++counter;
  };
  std::thread one(count);
  std::thread other(count);
  one.join();
  other.join();
  std::printf("%d\n", counter);
}
