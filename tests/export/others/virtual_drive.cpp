// Writes a recording of a drive of the virtual Create in virtual time: with a bump now and then.
// usage: virtual_drive FRAMES FILE
#include <cstdlib>
#include <fstream>

#include "tests/hal/recorded_drive.hpp"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const int frames = static_cast<int>(std::strtol(argv[1], nullptr, 10));
  constexpr std::size_t kBytesAFrame = 300;
  cargobay::hal::test::RecordedDrive drive{{}, static_cast<std::size_t>(frames) * kBytesAFrame};
  drive.on_frame = [&](int frame) {
    if (frame % 1000 == 500) drive.device.inputs().bump_left = true;
    if (frame % 1000 == 600) drive.device.inputs().bump_left = false;
  };
  drive.header.started_ns = 1'700'000'000'000'000'000;
  drive.run(frames);
  const auto bytes = drive.file();
  std::ofstream out{argv[2], std::ios::binary};
  for (const std::uint8_t byte : bytes) out.put(static_cast<char>(byte));
  return out.flush() ? 0 : 1;
}
