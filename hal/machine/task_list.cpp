#include "hal/machine/task_list.hpp"

#include <charconv>
#include <iterator>
#include <sstream>
#include <string_view>

#include "rt/kernel_file.hpp"

namespace cargobay::hal {
namespace {

namespace fs = std::filesystem;

template <typename Number>
std::optional<Number> number(std::string_view text) {
  Number value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

// proc(5): the name is in parentheses, and may hold any character.
std::optional<Task> read_task(const fs::path& folder) {
  constexpr std::size_t kParent = 1;  // counted from the state, the first after the name
  constexpr std::size_t kTerminal = 4;
  constexpr std::size_t kFlags = 6;
  constexpr std::size_t kPriorityWord = 37;
  constexpr unsigned long kKernelThread = 0x00200000;  // PF_KTHREAD
  const std::string stat = rt::kernel_file(folder / "stat");
  const std::size_t open = stat.find('(');
  const std::size_t close = stat.rfind(')');
  if (open == std::string::npos || close == std::string::npos) return std::nullopt;
  std::istringstream fields{stat.substr(close + 1)};
  const std::vector<std::string> words{std::istream_iterator<std::string>{fields}, {}};
  if (words.size() <= kPriorityWord) return std::nullopt;
  const auto id = number<pid_t>(folder.filename().string());
  const auto parent = number<pid_t>(words[kParent]);
  const auto terminal = number<long>(words[kTerminal]);
  const auto flags = number<unsigned long>(words[kFlags]);
  const auto priority = number<long>(words[kPriorityWord]);
  if (!id || !parent || !terminal || !flags || !priority) return std::nullopt;
  return Task{.id = *id,
              .name = stat.substr(open + 1, close - open - 1),
              .parent = *parent,
              .terminal = *terminal,
              .priority = *priority,
              .of_kernel = (*flags & kKernelThread) != 0};
}

std::vector<fs::path> processes(const fs::path& proc) {
  std::error_code error;
  std::vector<fs::path> found;
  for (fs::directory_iterator entry{proc, error}, end; !error && entry != end;
       entry.increment(error)) {
    if (number<pid_t>(entry->path().filename().string())) found.push_back(entry->path());
  }
  return found;
}

std::vector<Task> kernel_threads(const fs::path& proc) {
  std::vector<Task> found;
  for (const fs::path& process : processes(proc)) {
    const auto task = read_task(process);
    if (task && task->of_kernel) found.push_back(*task);
  }
  return found;
}

}  // namespace cargobay::hal
