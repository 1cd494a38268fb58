// A shell that runs a script beside the test, in a process group of its own.
#pragma once

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <string>

namespace cargobay::test {

class Shell {
 public:
  explicit Shell(std::string script) {
    std::string shell = "sh";
    std::string option = "-c";
    char* const words[] = {shell.data(), option.data(), script.data(), nullptr};
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    if (posix_spawn(&process_, "/bin/sh", nullptr, &attributes, words, environ) != 0) process_ = -1;
    posix_spawnattr_destroy(&attributes);
  }
  ~Shell() {
    if (process_ <= 0) return;
    kill(-process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  Shell(const Shell&) = delete;
  Shell& operator=(const Shell&) = delete;

  std::string name() const { return "sh (process " + std::to_string(process_) + ")"; }
  void stop() const { kill(-process_, SIGSTOP); }
  void go_on() const { kill(-process_, SIGCONT); }

 private:
  pid_t process_ = -1;
};

}  // namespace cargobay::test
