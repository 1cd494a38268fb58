#include "hal/sim/world/bodies.hpp"

#include <algorithm>

namespace cargobay::hal::sim {

std::size_t Bodies::enter() {
  const std::lock_guard lock{mutex_};
  const auto free = std::ranges::find(places_, false, &Place::taken);
  const auto number = static_cast<std::size_t>(free - places_.begin());
  if (free == places_.end()) places_.emplace_back();
  places_[number] = {.taken = true};
  return number;
}

void Bodies::leave(std::size_t number) {
  const std::lock_guard lock{mutex_};
  places_[number] = {};
}

void Bodies::tell(std::size_t number, const Body& body) {
  const std::lock_guard lock{mutex_};
  places_[number].body = body;
}

void Bodies::look(std::size_t number, std::vector<Body>& others) const {
  const std::lock_guard lock{mutex_};
  others.clear();
  for (std::size_t i = 0; i < places_.size(); ++i) {
    if (i != number && places_[i].body) others.push_back(*places_[i].body);
  }
}

}  // namespace cargobay::hal::sim
