// Expected is a strict subset of std::expected: the same code, which uses every member that it has,
// compiles with both and does the same. Without C++23 there is only one to try; CMakeLists.txt
// builds this as both.
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "hal/c/cargobay.hpp"

#if __cplusplus > 202002L
#include <expected>
#endif

namespace {

using cargobay::Error;
using cargobay::ErrorCode;

struct Ours {
  template <typename T>
  using Expected = cargobay::Expected<T>;
  using Unexpected = cargobay::Unexpected;
};

#if __cplusplus > 202002L
struct Standard {
  template <typename T>
  using Expected = std::expected<T, Error>;
  using Unexpected = std::unexpected<Error>;
};
#endif

void check(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "not so: %s\n", what);
  std::exit(1);  // NOLINT(concurrency-mt-unsafe): as C tests do it
}

constexpr Error kNone{.code = ErrorCode::no_frame, .message = "none"};

// `return` of a value, of what becomes one, and of an error.
template <typename Kind>
typename Kind::template Expected<std::string> word(int which) {
  if (which == 0) return std::string(40, 'x');
  if (which == 1) return "literal";
  return typename Kind::Unexpected{kNone};
}

// An error goes on to a function with another value.
template <typename Kind>
typename Kind::template Expected<std::size_t> length(int which) {
  const auto given = word<Kind>(which);
  if (!given) return typename Kind::Unexpected{given.error()};
  return given->size();
}

template <typename Kind>
typename Kind::template Expected<void> outcome(int which) {
  if (const auto counted = length<Kind>(which); !counted.has_value()) {
    return typename Kind::Unexpected{counted.error()};
  }
  return {};
}

template <typename Kind>
typename Kind::template Expected<std::unique_ptr<int>> owner(bool there) {
  if (!there) return typename Kind::Unexpected{kNone};
  return std::make_unique<int>(7);
}

template <typename Kind>
void has_values() {
  auto given = word<Kind>(0);
  const auto& seen = given;
  check(given.has_value() && static_cast<bool>(given), "there is a value");
  check(*given == std::string(40, 'x') && *seen == *given, "it is the one returned");
  *given += 'y';
  given->push_back('z');
  check(seen->size() == 42 && seen.value_or("other") == *seen, "it can be changed");
  check(word<Kind>(2).value_or("other") == "other", "the other value, if there is none");
  check(word<Kind>(1).value_or("other") == "literal", "what converts is a value");
  const std::string taken = *std::move(given);
  check(taken.size() == 42, "it can be moved out");
  const auto copy = seen;
  check(copy.has_value(), "it can be copied");
}

template <typename Kind>
void has_errors() {
  const auto none = length<Kind>(2);
  check(!none && !none.has_value() && none.error().code == ErrorCode::no_frame, "it has the code");
  check(std::string{none.error().message} == "none", "and the message");
  check(typename Kind::Unexpected{kNone}.error().code == ErrorCode::no_frame, "as handed over");
  auto changed = length<Kind>(0);
  check(changed && *changed == 40, "and now a value");
  changed = none;
  check(!changed && changed.error().code == ErrorCode::no_frame, "an error takes its place");
  const auto good = outcome<Kind>(0);
  const auto bad = outcome<Kind>(2);
  check(good.has_value() && static_cast<bool>(good), "success without a value");
  check(!bad && bad.error().code == ErrorCode::no_frame, "an error without a value");
}

// What only moves, as a Robot does.
template <typename Kind>
void moves() {
  auto held = owner<Kind>(true);
  const std::unique_ptr<int> taken = *std::move(held);
  check(*taken == 7, "it moves out");
  check(owner<Kind>(false).value_or(nullptr) == nullptr, "so does the other value");
  check(*owner<Kind>(true).value_or(nullptr) == 7, "and the value itself");
  using Held = decltype(held);
  static_assert(!std::is_copy_constructible_v<Held> && std::is_move_constructible_v<Held>);
  // An error must be named as one, or a function that returns an Error could not be told apart.
  static_assert(!std::is_convertible_v<Error, Held> && !std::is_convertible_v<Held, bool>);
  static_assert(std::is_convertible_v<typename Kind::Unexpected, Held>);
  static_assert(!std::is_convertible_v<Error, typename Kind::Unexpected>);
}

template <typename Kind>
void exercise() {
  has_values<Kind>();
  has_errors<Kind>();
  moves<Kind>();
}

}  // namespace

int main() {
  exercise<Ours>();
#if __cplusplus > 202002L
  exercise<Standard>();
  std::puts("the same as std::expected");
#endif
}
