#include "rt/memory_lock.hpp"

#include <link.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <fstream>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

#include "rt/kernel_file.hpp"

namespace cargobay::rt {
namespace {

std::error_code last_error() { return {errno, std::generic_category()}; }

std::uintptr_t address(const void* place) {
  return reinterpret_cast<std::uintptr_t>(place);  // NOLINT(*-reinterpret-cast): for page sums
}
void* place(std::uintptr_t address) {
  return reinterpret_cast<void*>(address);  // NOLINT(*-reinterpret-cast,performance-no-int-to-ptr)
}

std::size_t page_bytes() {
  static const auto kBytes = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  return kBytes;
}

struct Pages {
  std::uintptr_t first = 0;
  std::uintptr_t end = 0;
  std::size_t bytes() const { return end > first ? end - first : 0; }
};
Pages pages_around(Memory memory) {
  const std::uintptr_t page = page_bytes();
  const std::uintptr_t first = address(memory.data());
  return {.first = first / page * page, .end = (first + memory.size() + page - 1) / page * page};
}
Pages pages_within(Memory memory) {
  const std::uintptr_t page = page_bytes();
  const std::uintptr_t first = address(memory.data());
  return {.first = (first + page - 1) / page * page, .end = (first + memory.size()) / page * page};
}

// Whether the program itself has asked for MCL_FUTURE, which must not be undone here.
bool future_is_locked() {
  const std::size_t page = page_bytes();
  void* const fresh =
      mmap(nullptr, page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (fresh == MAP_FAILED) return false;
  unsigned char resident = 0;
  const bool locked = mincore(fresh, page, &resident) == 0 && (resident & 1U) != 0;
  munmap(fresh, page);
  return locked;
}

// The kernel grows a stack from its lowest page, and applies the lock limit only if that page is
// locked (mlock(2), kernel: acct_stack_growth()).
void let_main_stack_grow() {
  std::ifstream maps{"/proc/self/maps"};
  for (std::string line; std::getline(maps, line);) {
    if (!line.ends_with("[stack]")) continue;
    constexpr int kHexadecimal = 16;
    std::uintptr_t lowest = 0;
    std::from_chars(line.data(), line.data() + line.size(), lowest, kHexadecimal);
    if (lowest != 0) munlock(place(lowest), page_bytes());
  }
}

// The segments of the program or library that contains this function.
std::vector<Memory> own_code() {
  std::vector<Memory> segments;
  const auto visit = [](dl_phdr_info* object, std::size_t /*size*/, void* found) {
    auto& all = *static_cast<std::vector<Memory>*>(found);
    std::vector<Memory> of_object;
    bool ours = false;
    for (const ElfW(Phdr) & part : std::span{object->dlpi_phdr, object->dlpi_phnum}) {
      if (part.p_type != PT_LOAD) continue;
      const std::uintptr_t first = object->dlpi_addr + part.p_vaddr;
      of_object.emplace_back(static_cast<const std::byte*>(place(first)), part.p_memsz);
      const std::uintptr_t here = address(place(reinterpret_cast<std::uintptr_t>(&own_code)));
      ours = ours || (here >= first && here < first + part.p_memsz);
    }
    if (!ours) return 0;
    all = std::move(of_object);
    return 1;
  };
  dl_iterate_phdr(visit, &segments);
  return segments;
}

// Locks on all of the process, and whether the program had none of its own before the first.
struct Everything {
  std::mutex mutex{};
  int locks = 0;
  bool ours = false;
};
Everything& everything() {
  static Everything& shared = *new Everything;  // lives until the very end
  return shared;
}

bool anything_locked() {
  constexpr std::string_view kKey = "VmLck:";
  const std::string status = kernel_file("/proc/self/status");
  const std::size_t at = status.find(kKey);
  if (at == std::string::npos) return true;  // who knows
  const std::size_t number = status.find_first_not_of(" \t", at + kKey.size());
  return number == std::string::npos || status[number] != '0';
}

std::error_code lock_everything(int flags) {
  Everything& shared = everything();
  const std::lock_guard guard{shared.mutex};
  const bool before = shared.locks > 0 || anything_locked();
  if (mlockall(flags) != 0) return last_error();
  if (!before) shared.ours = true;
  ++shared.locks;
  return {};
}

void unlock_everything() {
  Everything& shared = everything();
  const std::lock_guard guard{shared.mutex};
  if (--shared.locks > 0 || !shared.ours) return;
  shared.ours = false;
  (void)munlockall();  // nothing to be done about a failure
}

}  // namespace

std::error_code MemoryLock::lock(const std::vector<Memory>& needed, const Rights& rights) {
  bytes_ = 0;
  for (const Memory memory : needed) bytes_ += pages_around(memory).bytes();
  if (!rights.lock_limit) {
    if (const std::error_code error = lock_everything(MCL_CURRENT | MCL_FUTURE)) return error;
    extent_ = Extent::all;
    return {};
  }
  if (rights.has(Capability::ipc_lock) &&
      !lock_everything(future_is_locked() ? MCL_CURRENT | MCL_FUTURE : MCL_CURRENT)) {
    let_main_stack_grow();
    extent_ = Extent::all;
    return {};
  }
  const std::error_code error = lock_pieces(needed, *rights.lock_limit);
  if (error) unlock();
  return error;
}

std::error_code MemoryLock::lock_pieces(const std::vector<Memory>& needed, std::uint64_t limit) {
  for (const Memory memory : needed) {
    const Pages pages = pages_around(memory);
    if (mlock(place(pages.first), pages.bytes()) != 0) return last_error();
    pieces_.push_back(memory);
  }
  extent_ = Extent::needed;
  std::size_t sum = bytes_;
  for (const Memory memory : own_code()) {
    const Pages pages = pages_around(memory);
    sum += pages.bytes();
    if (sum > limit / 4 * 3) break;
    // Stays locked: other loops may need it. If refused, it costs a page fault, once.
    (void)mlock(place(pages.first), pages.bytes());
  }
  return {};
}

void MemoryLock::unlock() {
  for (const Memory memory : std::exchange(pieces_, {})) {
    const Pages pages = pages_within(memory);
    if (pages.bytes() > 0) munlock(place(pages.first), pages.bytes());
  }
  if (std::exchange(extent_, Extent::none) == Extent::all) unlock_everything();
}

}  // namespace cargobay::rt
