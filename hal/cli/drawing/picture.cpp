#include "hal/cli/drawing/picture.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <optional>
#include <string_view>
#include <utility>

#include "hal/file/descriptor.hpp"
#include "hal/file/quiet_signals.hpp"

namespace cargobay::cli {
namespace {

constexpr const char* kConverter = "rsvg-convert";
constexpr std::array<std::string_view, 13> kOtherKinds{
    "jpg", "jpeg", "gif", "webp", "pdf", "ps", "eps", "bmp", "tif", "tiff", "emf", "avif", "svgz"};

// In small letters, without the dot; empty if there is none.
std::string ending(const std::string& path) {
  const std::string_view name = std::string_view{path}.substr(path.rfind('/') + 1);
  const std::size_t dot = name.rfind('.');
  if (dot == std::string_view::npos || dot == 0) return {};
  std::string end{name.substr(dot + 1)};
  std::ranges::transform(end, end.begin(), [](char c) {
    return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  });
  return end;
}

bool in_path(const std::string& program) {
  const char* const value = std::getenv("PATH");  // NOLINT(concurrency-mt-unsafe): nobody sets it
  std::string_view folders = value == nullptr ? "/usr/bin:/bin" : value;
  while (!folders.empty()) {
    const std::string_view folder = folders.substr(0, folders.find(':'));
    const std::string file = std::string{folder} + "/" + program;
    if (!folder.empty() && access(file.c_str(), X_OK) == 0) return true;
    folders.remove_prefix(std::min(folder.size() + 1, folders.size()));
  }
  return false;
}

// The converter, with its standard input and output at our ends of two pipes.
class Converter {
 public:
  Converter() = default;
  Converter(const Converter&) = delete;
  Converter& operator=(const Converter&) = delete;
  ~Converter() {
    input_ = hal::Descriptor{};
    output_ = hal::Descriptor{};
    if (child_ > 0) waitpid(child_, nullptr, 0);
  }

  bool start() {
    std::array<int, 2> in{};
    std::array<int, 2> out{};
    if (pipe2(in.data(), O_CLOEXEC) != 0) return false;
    const hal::Descriptor its_input{in[0]};
    input_ = hal::Descriptor{in[1]};
    if (pipe2(out.data(), O_CLOEXEC) != 0) return false;
    output_ = hal::Descriptor{out[0]};
    const hal::Descriptor its_output{out[1]};
    posix_spawn_file_actions_t actions{};
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, its_input.number(), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, its_output.number(), STDOUT_FILENO);
    // Our signals are blocked; it must receive its own.
    sigset_t none{};
    sigset_t all{};
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_t attributes{};
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    std::string name = kConverter;
    std::string format = "--format=png";
    std::array<char*, 3> arguments{name.data(), format.data(), nullptr};
    const int error =
        posix_spawnp(&child_, kConverter, &actions, &attributes, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    if (error != 0) child_ = -1;
    return error == 0;
  }

  // Writes while it reads: neither pipe holds a whole drawing.
  std::optional<std::string> convert(std::string_view svg) {
    fcntl(input_.number(), F_SETFL, O_NONBLOCK);
    std::string png;
    for (bool more = true; more;) {
      std::array<pollfd, 2> ends{
          {{.fd = output_.number(), .events = POLLIN, .revents = 0},
           {.fd = input_.number(), .events = POLLOUT, .revents = 0}}};  // -1 is ignored
      if (poll(ends.data(), ends.size(), -1) < 0 && errno != EINTR) return std::nullopt;
      if (ends[1].revents != 0) svg = write_some(svg);
      if (ends[0].revents != 0) more = read_some(png);
    }
    int status = 0;
    if (waitpid(std::exchange(child_, -1), &status, 0) < 0 || status != 0) return std::nullopt;
    return png;
  }

 private:
  // Returns what is left, and closes the input after the last byte, or if nothing reads it.
  std::string_view write_some(std::string_view svg) {
    const ssize_t count = ::write(input_.number(), svg.data(), svg.size());
    if (count > 0) svg.remove_prefix(static_cast<std::size_t>(count));
    const bool broken = count < 0 && errno != EAGAIN && errno != EINTR;
    if (svg.empty() || broken) input_ = hal::Descriptor{};
    return svg;
  }
  // Whether there may be more.
  bool read_some(std::string& png) {
    std::array<char, 65536> bytes{};
    const ssize_t count = ::read(output_.number(), bytes.data(), bytes.size());
    if (count > 0) png.append(bytes.data(), static_cast<std::size_t>(count));
    return count > 0 || (count < 0 && errno == EINTR);
  }

  hal::Descriptor input_{};
  hal::Descriptor output_{};
  pid_t child_ = -1;
};

}  // namespace

hal::Result<void> check_picture_name(const std::string& option, const std::string& path) {
  const std::string end = ending(path);
  if (std::ranges::find(kOtherKinds, end) != kOtherKinds.end()) {
    return hal::Failure{option + " draws SVG and PNG, not ." + end + "; name the file " +
                        path.substr(0, path.rfind('.')) + ".svg or .png"};
  }
  if (end != "png" || in_path(kConverter)) return {};
  return hal::Failure{option + " " + path +
                      " needs rsvg-convert, which is not installed: apt-get install "
                      "librsvg2-bin, or name the file " +
                      path.substr(0, path.rfind('.')) + ".svg"};
}

hal::Result<std::string> picture(std::string svg, const std::string& path) {
  if (ending(path) != "png") return svg;
  const hal::QuietSignals quiet;  // a converter that ends early must not end us
  Converter converter;
  if (converter.start()) {
    if (auto png = converter.convert(svg)) return std::move(*png);
  }
  return hal::Failure{std::string{kConverter} + " could not make " + path +
                      " of the drawing; name it .svg to have that"};
}

}  // namespace cargobay::cli
