#include "hal/cli/live/steering_keys.hpp"

namespace cargobay::cli {
namespace {

constexpr char kEscape = '\x1b';

SteeringKey letter(char byte) {
  switch (byte) {
    case 'w':
    case 'W': return SteeringKey::forward;
    case 's':
    case 'S': return SteeringKey::back;
    case 'a':
    case 'A': return SteeringKey::left;
    case 'd':
    case 'D': return SteeringKey::right;
    case ' ': return SteeringKey::stop;
    case '+':
    case '=': return SteeringKey::faster;  // the same key without Shift
    case '-': return SteeringKey::slower;
    case 't':
    case 'T': return SteeringKey::take;
    case 'r':
    case 'R': return SteeringKey::rearm;
    case 'q':
    case 'Q': return SteeringKey::quit;
    default: return SteeringKey::other;
  }
}

SteeringKey arrow(char byte) {
  switch (byte) {
    case 'A': return SteeringKey::forward;
    case 'B': return SteeringKey::back;
    case 'C': return SteeringKey::right;
    case 'D': return SteeringKey::left;
    default: return SteeringKey::other;
  }
}

}  // namespace

SteeringKey KeyDecoder::next(char byte) {
  if (byte == kEscape) {
    inside_ = Inside::escape;
    return SteeringKey::other;
  }
  switch (inside_) {
    case Inside::nothing: return letter(byte);
    case Inside::escape:
      if (byte == '[' || byte == 'O') {
        inside_ = Inside::sequence;
        return SteeringKey::other;
      }
      inside_ = Inside::nothing;
      return letter(byte);
    case Inside::sequence:
      // Numbers, as in "[1;2A" of an arrow with Shift, come before its letter.
      if ((byte >= '0' && byte <= '9') || byte == ';') return SteeringKey::other;
      inside_ = Inside::nothing;
      return arrow(byte);
  }
  return SteeringKey::other;
}

void HeldKeys::press(SteeringKey key, rt::TimePoint now) {
  switch (key) {
    case SteeringKey::forward:
    case SteeringKey::back:
      forward_ = key == SteeringKey::forward ? 1.0 : -1.0;
      forward_until_ = now + kCounts;
      break;
    case SteeringKey::left:
    case SteeringKey::right:
      turn_ = key == SteeringKey::left ? 1.0 : -1.0;
      turn_until_ = now + kCounts;
      break;
    case SteeringKey::stop: let_go(); break;
    case SteeringKey::faster:
    case SteeringKey::slower:
    case SteeringKey::take:
    case SteeringKey::rearm:
    case SteeringKey::quit:
    case SteeringKey::other: break;
  }
}

Wish HeldKeys::wish(rt::TimePoint now) const {
  return {.forward = now < forward_until_ ? forward_ : 0.0,
          .turn = now < turn_until_ ? turn_ : 0.0};
}

}  // namespace cargobay::cli
