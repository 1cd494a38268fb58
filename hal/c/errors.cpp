#include "hal/c/errors.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>

namespace cargobay::c {
namespace {

// What is said by functions that must not allocate fits in here, in memory that each thread has
// from its beginning: with the initial-exec model the first use needs no call into the loader, even
// in a library that dlopen() loaded. Such memory is scarce, so it is small.
constexpr std::size_t kShort = 320;
constexpr std::size_t kLong = 1024;

// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables): each thread's own
__attribute__((tls_model("initial-exec"))) thread_local std::array<char, kShort> short_message{};
__attribute__((tls_model("initial-exec"))) thread_local const char* last_message = "";
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

using LongMessage = std::array<char, kLong>;

LongMessage& long_message() {
  thread_local std::unique_ptr<LongMessage> message = std::make_unique<LongMessage>();
  return *message;
}

template <std::size_t kSize>
void keep_message(std::array<char, kSize>& buffer, std::string_view message) noexcept {
  const std::size_t length = std::min(message.size(), buffer.size() - 1);
  std::memmove(buffer.data(), std::to_address(message.begin()), length);
  buffer[length] = '\0';
  last_message = buffer.data();
}

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
  if (message.size() < kShort) {
    keep_message(short_message, message);
    return code;
  }
  try {
    keep_message(long_message(), message);
  } catch (const std::bad_alloc&) {
    keep_message(short_message, message);
  }
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

const char* last_failure() noexcept { return last_message; }

}  // namespace cargobay::c
