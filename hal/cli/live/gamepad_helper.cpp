#include "hal/cli/live/gamepad_helper.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

namespace cargobay::cli {
namespace {

constexpr std::string_view kGamepadProgram = "cargobay-gamepad";

// Beside this program, or where the guard is; empty if it is at neither place.
std::string helper_path() {
  std::error_code error;
  const auto here = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  if (error) return {};
  for (const auto& path :
       {here / kGamepadProgram, here.parent_path() / "lib/cargobay" / kGamepadProgram})
    if (access(path.c_str(), X_OK) == 0) return path.string();
  return {};
}

hal::Failure cannot_start(int error) {
  const std::error_code code{error, std::generic_category()};
  return {.message = "cannot start " + std::string{kGamepadProgram} + ": " + code.message(),
          .code = code};
}

// Not ours: signals that end this command are blocked here, and are to end the child too.
int spawn(pid_t& process, const std::vector<std::string>& words, int output) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions{};
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawnattr_t attributes{};
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigset_t all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  const int error =
      posix_spawn(&process, arguments[0], &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  return error;
}

// The next number of the line, of which it is taken; nothing if there is none from -1 to 1.
std::optional<double> next_part(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
  double value = 0.0;
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), value);
  if (error != std::errc{} || !(value >= -1.0 && value <= 1.0)) return std::nullopt;
  line.remove_prefix(static_cast<std::size_t>(end - line.data()));
  return value;
}

}  // namespace

hal::Result<GamepadHelper> GamepadHelper::start(const std::string& device) {
  const std::string path = helper_path();
  if (path.empty()) {
    return hal::Failure{
        "no program cargobay-gamepad, which reads gamepads: sudo apt install cargobay-web"};
  }
  std::array<int, 2> pipe{-1, -1};
  if (pipe2(pipe.data(), O_CLOEXEC) != 0) return cannot_start(errno);
  hal::Descriptor lines{pipe[0]};
  const hal::Descriptor writing{pipe[1]};
  (void)fcntl(lines.number(), F_SETFL, O_NONBLOCK);  // of a pipe that was just made
  std::vector<std::string> words{path};
  if (!device.empty()) words.push_back(device);
  pid_t process = -1;
  if (const int error = spawn(process, words, writing.number()); error != 0)
    return cannot_start(error);
  return GamepadHelper{process, std::move(lines)};
}

GamepadHelper::GamepadHelper(pid_t process, hal::Descriptor lines)
    : process_{process}, lines_{std::move(lines)} {}

GamepadHelper::GamepadHelper(GamepadHelper&& other) noexcept
    : process_{std::exchange(other.process_, -1)},
      lines_{std::move(other.lines_)},
      received_{std::move(other.received_)},
      name_{std::move(other.name_)},
      wish_{other.wish_},
      silent_{other.silent_},
      until_{other.until_} {}

GamepadHelper::~GamepadHelper() {
  if (process_ <= 0) return;
  (void)kill(process_, SIGKILL);  // it holds nothing but a device that it reads
  (void)waitpid(process_, nullptr, 0);
}

hal::Result<void> GamepadHelper::take(rt::TimePoint now) {
  for (;;) {
    std::array<char, 1024> bytes{};
    const ssize_t count = read(lines_.number(), bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) break;
    if (count == 0) {
      wish_ = {};
      return hal::Failure{"the gamepad is gone, or there was none: start again with --gamepad"};
    }
    received_.append(bytes.data(), static_cast<std::size_t>(count));
  }
  std::size_t begin = 0;
  for (std::size_t end = received_.find('\n'); end != std::string::npos;
       end = received_.find('\n', begin)) {
    hear(std::string_view{received_}.substr(begin, end - begin), now);
    begin = end + 1;
  }
  received_.erase(0, begin);
  return {};
}

void GamepadHelper::hear(std::string_view line, rt::TimePoint now) {
  constexpr std::string_view kName = "gamepad ";
  constexpr std::string_view kDrive = "drive ";
  if (line.starts_with(kName)) name_ = line.substr(kName.size());
  wish_ = {};
  silent_ = line == "silent";
  if (!line.starts_with(kDrive)) return;  // "stand"
  line.remove_prefix(kDrive.size());
  const auto forward = next_part(line);
  const auto turn = next_part(line);
  if (!forward || !turn) return;
  wish_ = {.forward = *forward, .turn = *turn};
  until_ = now + kCounts;
}

void GamepadHelper::skip_to_now() {
  (void)take({});  // its end is seen again by the next call
  wish_ = {};
}

Wish GamepadHelper::wish(rt::TimePoint now) const { return now < until_ ? wish_ : Wish{}; }

}  // namespace cargobay::cli
