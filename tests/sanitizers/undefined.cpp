// Wrong on purpose: a signed overflow.
#include <cstdio>
#include <limits>

int main(int argc, char** /*argv*/) { std::printf("%d\n", std::numeric_limits<int>::max() + argc); }
