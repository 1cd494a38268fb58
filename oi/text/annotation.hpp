// A remark on some bytes, and the sink that receives it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>

#include "oi/text/text_writer.hpp"

namespace cargobay::oi {

struct Annotation {
  enum class Kind : std::uint8_t {
    // What the host sends.
    opcode,
    argument,
    element,  // a packet of a list, a note
    command,  // after all bytes of a whole command: these bytes, and its text form
    unknown_opcode,
    // What the robot sends.
    header,
    length,
    packet,
    value,
    checksum,
    printed,  // text
    stray,    // bytes that belong to nothing known
    // Either.
    missing,  // the end, although bytes should follow: `bytes` is empty
  };
  Kind kind = Kind::stray;
  std::size_t offset = 0;  // of the first of the bytes
  std::span<const std::uint8_t> bytes{};
  std::string_view text{};  // what they mean; valid during the call
  bool sound = true;        // false if the manual does not allow this
  bool in_script = false;
};

// Refers to what is called with each annotation, in the order of the bytes: for example a lambda
// that is not mutable. It must outlive the sink.
class AnnotationSink {
 public:
  template <typename Callable>
    requires(!std::is_same_v<std::remove_cvref_t<Callable>, AnnotationSink>)
  // NOLINTNEXTLINE(google-explicit-constructor): implicit, so that a lambda can be passed
  AnnotationSink(const Callable& callable)
      : callable_{&callable}, call_{[](const void* target, const Annotation& annotation) {
          (*static_cast<const Callable*>(target))(annotation);
        }} {}

  void operator()(const Annotation& annotation) const { call_(callable_, annotation); }

 private:
  const void* callable_;
  void (*call_)(const void*, const Annotation&);
};

// How the description ended.
struct Described {
  std::size_t unsound = 0;  // annotations that are not sound
  std::size_t needed = 0;   // at least this many more bytes complete what was cut short
};

// Words annotations and counts the unsound ones.
class Annotator {
 public:
  Annotator(std::span<const std::uint8_t> bytes, const AnnotationSink& sink)
      : bytes_{bytes}, sink_{sink} {}

  // Begins the text of the next annotation.
  TextWriter& words() {
    words_.clear();
    return words_;
  }
  // Reports bytes with what words() has been given.
  void tell(Annotation::Kind kind, std::size_t offset, std::size_t count, bool sound = true) {
    tell_text(kind, offset, count, words_.text(), sound);
  }
  void tell_text(Annotation::Kind kind, std::size_t offset, std::size_t count,
                 std::string_view text, bool sound = true) {
    if (!sound) ++described_.unsound;
    sink_({.kind = kind,
           .offset = offset,
           .bytes = bytes_.subspan(offset, count),
           .text = text,
           .sound = sound,
           .in_script = in_script_});
  }
  // The bytes end although `needed` more should follow.
  void tell_missing(std::size_t needed) {
    described_.needed = needed;
    TextWriter& text = words();
    text.put("needs ");
    text.put_number(static_cast<std::int64_t>(needed));
    text.put(needed == 1 ? " more byte" : " more bytes");
    tell(Annotation::Kind::missing, bytes_.size(), 0, false);
  }
  void enter_script() { in_script_ = true; }
  void leave_script() { in_script_ = false; }
  const Described& described() const { return described_; }

 private:
  std::span<const std::uint8_t> bytes_;
  AnnotationSink sink_;
  Described described_{};
  bool in_script_ = false;
  std::array<char, 256> buffer_{};
  TextWriter words_{buffer_};
};

}  // namespace cargobay::oi
