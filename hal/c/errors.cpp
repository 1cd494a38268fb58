#include "hal/c/errors.hpp"

#include <algorithm>
#include <array>
#include <cstring>

namespace cargobay::c {
namespace {

// In fixed memory: reporting a lack of memory must not need any.
constexpr std::size_t kMostMessage = 1024;
// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables): each thread's own
thread_local std::array<char, kMostMessage> last_message{};

// What each kind is called, and how it is opened; indexed by its number.
struct KindWords {
  std::string_view name{};
  std::string_view a{};
  std::string_view open{};
};
constexpr std::array<KindWords, 4> kKinds{
    {{},
     {"robot", "a robot", "cargobay_open()"},
     {"virtual Create", "a virtual Create", "cargobay_sim_open()"},
     {"histogram", "a histogram", "cargobay_histogram_open()"}}};

const KindWords& words(HandleKind kind) { return kKinds[static_cast<std::size_t>(kind)]; }

}  // namespace

int fail(int code, std::string_view message) noexcept {
  const std::size_t length = std::min(message.size(), kMostMessage - 1);
  std::memcpy(last_message.data(), message.data(), length);
  last_message[length] = '\0';
  return code;
}

// Formats into memory of its own, since real-time safe functions call it too.
int bad_handle(const void* handle, HandleKind wanted) noexcept {
  std::array<char, 160> said{};
  std::size_t length = 0;
  const auto say = [&](std::string_view part) {
    const std::size_t count = std::min(part.size(), said.size() - length);
    std::memcpy(said.data() + length, part.data(), count);
    length += count;
  };
  const KindWords& as = words(wanted);
  const HandleKind kind = kind_of(reinterpret_cast<std::uintptr_t>(handle));
  if (kind != HandleKind::none && kind != wanted) {
    say("this is the handle of ");
    say(words(kind).a);
    say(", not of ");
    say(as.a);
    say(": pass the right one");
    return fail(CARGOBAY_E_HANDLE, {said.data(), length});
  }
  say("this ");
  say(as.name);
  say(handle == nullptr          ? " is NULL"
      : kind == HandleKind::none ? " is not a handle of this library"
                                 : " is closed, or the parent process's");
  say("; open one with ");
  say(as.open);
  return fail(CARGOBAY_E_HANDLE, {said.data(), length});
}

}  // namespace cargobay::c

extern "C" {

const char* cargobay_error_message(void) { return cargobay::c::last_message.data(); }

const char* cargobay_error_name(int error) {
  switch (error) {
    case CARGOBAY_OK: return "CARGOBAY_OK";
    case CARGOBAY_E_ARGUMENT: return "CARGOBAY_E_ARGUMENT";
    case CARGOBAY_E_HANDLE: return "CARGOBAY_E_HANDLE";
    case CARGOBAY_E_STATE: return "CARGOBAY_E_STATE";
    case CARGOBAY_E_CONFIG: return "CARGOBAY_E_CONFIG";
    case CARGOBAY_E_SYSTEM: return "CARGOBAY_E_SYSTEM";
    case CARGOBAY_E_PORT: return "CARGOBAY_E_PORT";
    case CARGOBAY_E_RIGHTS: return "CARGOBAY_E_RIGHTS";
    case CARGOBAY_E_ROBOT: return "CARGOBAY_E_ROBOT";
    case CARGOBAY_E_MODE: return "CARGOBAY_E_MODE";
    case CARGOBAY_E_CONTROL: return "CARGOBAY_E_CONTROL";
    case CARGOBAY_E_STALLED: return "CARGOBAY_E_STALLED";
    case CARGOBAY_E_FULL: return "CARGOBAY_E_FULL";
    case CARGOBAY_E_TIMEOUT: return "CARGOBAY_E_TIMEOUT";
    case CARGOBAY_E_GUARD: return "CARGOBAY_E_GUARD";
    default: return "CARGOBAY_E_?";
  }
}

const char* cargobay_version(void) { return CARGOBAY_VERSION; }

}  // extern "C"
