#include "hal/web/program/token_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>

#include "hal/file/descriptor.hpp"
#include "hal/file/output_file.hpp"
#include "hal/web/token.hpp"

namespace cargobay::web {
namespace {

constexpr mode_t kForGroup = S_IRUSR | S_IWUSR | S_IRGRP;

hal::Failure failed(const std::string& path, const std::string& why) {
  return {.message = "--token-file " + path + ": " + why};
}

std::string words_of(int error) {
  return std::generic_category().message(error) +
         "; name a file that this user owns, in a folder that it may write to";
}

// Nothing that it makes is for others.
class OnlyMine {
 public:
  OnlyMine() : before_{umask(S_IRWXG | S_IRWXO)} {}
  ~OnlyMine() { (void)umask(before_); }
  OnlyMine(const OnlyMine&) = delete;
  OnlyMine& operator=(const OnlyMine&) = delete;

 private:
  mode_t before_;
};

hal::Result<std::string> make(const std::string& path) {
  const auto token = make_token();
  if (!token)
    return failed(path, "the kernel gives no random numbers for a token; put one into the file");
  const OnlyMine mine;
  auto file = hal::OutputFile::open(path);
  if (!file) return failed(path, file.failure().message);
  if (const auto written = file->write(*token + "\n"); !written)
    return failed(path, written.failure().message);
  if (const auto published = file->publish(); !published)
    return failed(path, published.failure().message);
  if (chmod(path.c_str(), kForGroup) != 0) return failed(path, words_of(errno));
  return *token;
}

}  // namespace

hal::Result<std::string> token_in(const std::string& path) {
  const int opened = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  const int error = opened < 0 ? errno : 0;
  if (error == ENOENT) return make(path);
  if (error != 0) return failed(path, words_of(error));
  const hal::Descriptor file{opened};
  struct stat status{};
  if (fstat(file.number(), &status) != 0) return failed(path, words_of(errno));
  if (!S_ISREG(status.st_mode))
    return failed(path, "not a file; name one, or a path where one can be made");
  if ((status.st_mode & S_IRWXO) != 0)
    return failed(path, "every user of this machine can use it: chmod o= " + path);
  std::array<char, kMostTokenLength + 2> text{};
  const ssize_t count = read(file.number(), text.data(), text.size());
  std::string token{text.data(), count > 0 ? static_cast<std::size_t>(count) : 0};
  if (token.ends_with('\n')) token.pop_back();
  if (!is_token(token))
    return failed(path,
                  "has no token: 8 to 128 letters, digits, or any of - _ . ~ in one line; "
                  "remove it, and one is made");
  return token;
}

}  // namespace cargobay::web
