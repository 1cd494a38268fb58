// Runs the command `cargobay` as a shell would: arguments and standard input in, exit code and
// output out.
#pragma once

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace cargobay::test {

struct Outcome {
  int code = -1;  // 128 + N if signal N ended it
  std::string out;
  std::string error;
};

class ToolProcess {
 public:
  explicit ToolProcess(const std::vector<std::string>& arguments, const std::string& input = "")
      : input_{temporary_file(input)},
        output_{temporary_file("")},
        error_{temporary_file("")},
        process_{start(arguments)} {}
  // Its standard input is this file, which is removed in the end.
  struct InputFile {
    std::string path;
  };
  ToolProcess(const std::vector<std::string>& arguments, InputFile input)
      : input_{std::move(input.path)},
        output_{temporary_file("")},
        error_{temporary_file("")},
        process_{start(arguments)} {}
  ~ToolProcess() {
    if (process_ > 0) {
      kill(process_, SIGKILL);
      waitpid(process_, nullptr, 0);
    }
    for (const std::string& file : {input_, output_, error_}) unlink(file.c_str());
  }
  ToolProcess(const ToolProcess&) = delete;
  ToolProcess& operator=(const ToolProcess&) = delete;

  void send_signal(int signal) const { kill(process_, signal); }
  std::string printed_so_far() const { return content(output_) + content(error_); }
  // Waits for its end; the limit is ctest's time limit.
  Outcome wait() {
    int status = 0;
    waitpid(process_, &status, 0);
    process_ = -1;
    return {.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
            .out = content(output_),
            .error = content(error_)};
  }

 private:
  // Everything the child needs is prepared before the fork: there are other threads here.
  pid_t start(std::vector<std::string> words) const {
    words.insert(words.begin(), CARGOBAY_BINARY_DIR "/cargobay");
    std::vector<char*> argv;
    argv.reserve(words.size() + 1);
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const pid_t process = fork();
    if (process != 0) return process;
    redirect(input_, O_RDONLY, STDIN_FILENO);
    redirect(output_, O_WRONLY, STDOUT_FILENO);
    redirect(error_, O_WRONLY, STDERR_FILENO);
    execv(argv[0], argv.data());
    _exit(127);
  }
  static std::string temporary_file(const std::string& content) {
    std::string path = "/tmp/cargobay-tool-XXXXXX";
    close(mkstemp(path.data()));
    std::ofstream{path, std::ios::binary} << content;
    return path;
  }
  static void redirect(const std::string& path, int flags, int descriptor) {
    const int file = open(path.c_str(), flags | O_CLOEXEC);
    if (file < 0 || dup2(file, descriptor) < 0) _exit(126);
  }
  static std::string content(const std::string& path) {
    std::ostringstream text;
    text << std::ifstream{path, std::ios::binary}.rdbuf();
    return text.str();
  }

  std::string input_;
  std::string output_;
  std::string error_;
  pid_t process_;
};

inline Outcome run_tool(const std::vector<std::string>& arguments, const std::string& input = "") {
  return ToolProcess{arguments, input}.wait();
}

}  // namespace cargobay::test
