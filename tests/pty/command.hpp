// The built command as a user runs it: in its own process, its output collected.
#pragma once

#include <sys/types.h>

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace cargobay::test {

class Command {
 public:
  struct Setup {
    // pipe: standard output is not a terminal. terminal: it is one, and the command its session.
    // unread: a full pipe that nothing reads. full: a device that takes nothing, /dev/full.
    enum class Output : std::uint8_t { pipe, terminal, unread, full } output = Output::pipe;
    // nobody: without any right beyond those of an ordinary user, real-time ones included. If the
    // tests do not run as root, the same user without them.
    enum class User : std::uint8_t { same, nobody } user = User::same;
    // Descriptors 0 to 2, closed as by `>&-`.
    std::array<bool, 3> closed{};
    // As `ulimit -f` sets it; 0 for none.
    std::uint64_t most_file_bytes = 0;
  };

  explicit Command(std::vector<std::string> arguments) : Command{std::move(arguments), Setup{}} {}
  Command(std::vector<std::string> arguments, const Setup& setup);
  // Kills it if it still runs.
  ~Command();
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;

  pid_t process() const { return process_; }
  void send(int signal) const;
  void type(std::string_view keys) const;  // on its terminal
  void close_terminal();
  // Whoever reads its standard output stops reading.
  void close_output() { close_terminal(); }
  // Also collects what it has printed.
  bool running();
  // Waits for its end: its exit code, -N if signal N killed it, or kHangs.
  int exit_code();
  static constexpr int kHangs = -1000;

  // What it had printed when running() or exit_code() last looked.
  const std::string& out() const { return out_; }
  const std::string& err() const { return err_; }

 private:
  pid_t process_ = -1;
  int status_ = 0;
  bool ended_ = false;
  bool unread_ = false;
  int out_descriptor_ = -1;  // the terminal's master, if there is one
  int err_descriptor_ = -1;
  std::string out_;
  std::string err_;
};

}  // namespace cargobay::test
