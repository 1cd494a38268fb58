#include "hal/trouble.hpp"

#include <string>

namespace cargobay::hal {
namespace {

class Category final : public std::error_category {
 public:
  const char* name() const noexcept override { return "cargobay"; }
  std::string message(int trouble) const override {
    switch (static_cast<Trouble>(trouble)) {
      case Trouble::silent: return "the robot does not answer";
      case Trouble::unruly: return "the robot does not go on answering";
      case Trouble::wrong_mode: return "the robot does not go to its mode";
      case Trouble::cancelled: return "cancelled";
      case Trouble::pin: return "a pin cannot be used";
      case Trouble::hung_up: return "the port hung up";
      case Trouble::guard: return "there is no guard";
      case Trouble::unconfirmed: return "the robot may be moving";
      case Trouble::no_thread: return "no thread could be started";
    }
    return "unknown";
  }
  std::error_condition default_error_condition(int trouble) const noexcept override {
    if (static_cast<Trouble>(trouble) == Trouble::cancelled)
      return std::make_error_condition(std::errc::operation_canceled);
    return {trouble, *this};
  }
};

}  // namespace

const std::error_category& trouble_category() noexcept {
  static const Category kCategory;
  return kCategory;
}

}  // namespace cargobay::hal
