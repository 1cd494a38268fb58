// What a set-up step returns: a value if it has one, or a failure that the user can act on.
#pragma once

#include <cassert>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <variant>

namespace cargobay::hal {

// One line: what failed, and what to do about it.
struct Failure {
  std::string message;
  std::error_code code{};  // the system's, if there is one
};

template <typename T>
class [[nodiscard]] Result {
 public:
  // Implicit, for `return value;` and `return Failure{...};`.
  // NOLINTBEGIN(google-explicit-constructor): implicit on purpose, as said above
  Result(T value) : content_{std::move(value)} {}
  Result(Failure failure) : content_{std::move(failure)} {}
  // NOLINTEND(google-explicit-constructor)

  explicit operator bool() const { return content_.index() == 0; }
  T& operator*() {
    assert(*this);
    return std::get<0>(content_);
  }
  const T& operator*() const {
    assert(*this);
    return std::get<0>(content_);
  }
  T* operator->() { return &**this; }
  const T* operator->() const { return &**this; }
  const Failure& failure() const {
    assert(!*this);
    return std::get<1>(content_);
  }

 private:
  std::variant<T, Failure> content_;
};

// A step that is done, or failed.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): implicit on purpose, for `return Failure{...};`
  Result(Failure failure) : failure_{std::move(failure)} {}

  explicit operator bool() const { return !failure_; }
  const Failure& failure() const {
    assert(failure_);
    return *failure_;
  }

 private:
  std::optional<Failure> failure_{};
};

}  // namespace cargobay::hal
