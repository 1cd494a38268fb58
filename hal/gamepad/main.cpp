// cargobay-gamepad: reads a gamepad for `cargobay teleop`, which runs it. Prints its name, and then
// what it says each time that changes, and ten times a second while a shoulder button is held:
//   gamepad NAME
//   drive FORWARD TURN      from -1 to 1, left positive; a shoulder button is held
//   stand                   it is not
//   silent                  it is, but nothing has moved for 2 s: the gamepad may be out of range
// It ends when the gamepad is gone, or when nothing reads what it prints. A reader that hears
// nothing for 400 ms takes that for `stand`.
// usage: cargobay-gamepad [/dev/input/eventN]

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <libevdev/libevdev.h>

#include "hal/file/descriptor.hpp"
#include "hal/gamepad/gamepad.hpp"

namespace {

namespace gamepad = cargobay::gamepad;
using cargobay::hal::Descriptor;

constexpr int kRepeatMs = 100;
constexpr int kUsageError = 2;

using Device = std::unique_ptr<libevdev, void (*)(libevdev*)>;

struct OpenDevice {
  Descriptor descriptor{-1};
  Device device{nullptr, libevdev_free};
};

OpenDevice open_device(const std::string& path) {
  OpenDevice open{.descriptor =
                      Descriptor{::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)}};
  libevdev* device = nullptr;
  if (open.descriptor.number() >= 0 && libevdev_new_from_fd(open.descriptor.number(), &device) == 0)
    open.device.reset(device);
  return open;
}

// In the order of their numbers.
std::vector<std::string> device_paths() {
  std::vector<std::string> paths;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator{"/dev/input", error}) {
    if (entry.path().filename().string().starts_with("event"))
      paths.push_back(entry.path().string());
  }
  std::ranges::sort(paths, [](const std::string& a, const std::string& b) {
    return a.size() != b.size() ? a.size() < b.size() : a < b;
  });
  return paths;
}

int fail(const std::string& message) {
  (void)std::fprintf(stderr, "cargobay-gamepad: error: %s\n", message.c_str());
  return 1;
}

bool say(const std::string& line) {
  return std::printf("%s\n", line.c_str()) > 0 && std::fflush(stdout) == 0;
}

// Takes all events that wait. False if the device is gone.
bool take_events(libevdev* device, gamepad::Gamepad& pad) {
  for (;;) {
    input_event event{};
    int result = libevdev_next_event(device, LIBEVDEV_READ_FLAG_NORMAL, &event);
    // Events were lost: libevdev asks for the state instead, in events of its own.
    while (result == LIBEVDEV_READ_STATUS_SYNC)
      result = libevdev_next_event(device, LIBEVDEV_READ_FLAG_SYNC, &event);
    if (result == -EAGAIN) return true;
    if (result >= 0) pad.hear(std::chrono::steady_clock::now());
    if (result < 0 && result != -EINTR) return false;
  }
}

int follow(OpenDevice& open) {
  gamepad::Gamepad pad{open.device.get(), std::chrono::steady_clock::now()};
  const char* const name = libevdev_get_name(open.device.get());
  if (!say(std::string{"gamepad "} + (name == nullptr ? "" : name))) return 1;
  std::string said;
  for (;;) {
    std::string line = pad.line(std::chrono::steady_clock::now());
    if (line != said || pad.is_held()) {
      if (!say(line)) return 1;
      said = std::move(line);
    }
    std::array<pollfd, 2> waited{{{.fd = open.descriptor.number(), .events = POLLIN, .revents = 0},
                                  {.fd = STDOUT_FILENO, .events = 0, .revents = 0}}};
    if (poll(waited.data(), waited.size(), kRepeatMs) < 0 && errno != EINTR)
      return fail("poll: " + std::generic_category().message(errno));
    if ((waited[1].revents & (POLLERR | POLLHUP)) != 0) return 0;
    if (!take_events(open.device.get(), pad)) return fail("the gamepad is gone");
  }
}

int run(const std::string& wanted) {
  if (!wanted.empty()) {
    OpenDevice open = open_device(wanted);
    if (!open.device)
      return fail("cannot read " + wanted + ": " + std::generic_category().message(errno));
    if (!gamepad::Gamepad::is_one(open.device.get()))
      return fail(wanted + " has no stick with shoulder buttons");
    return follow(open);
  }
  bool refused = false;
  for (const std::string& path : device_paths()) {
    OpenDevice open = open_device(path);
    refused = refused || (!open.device && errno == EACCES);
    if (open.device && gamepad::Gamepad::is_one(open.device.get())) return follow(open);
  }
  return fail(refused ? "no gamepad that this user may read; join the group input, or plug one in"
                      : "no gamepad is plugged in");
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words{argv + std::min(argc, 1), argv + argc};
  if (words.size() > 1 || (!words.empty() && words[0].starts_with("-"))) {
    (void)std::fprintf(stderr, "usage: cargobay-gamepad [/dev/input/eventN]\n");
    return kUsageError;
  }
  return run(words.empty() ? "" : words[0]);
}
