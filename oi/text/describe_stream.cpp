// The robot's side: describe_stream() and describe_reply().
#include <algorithm>
#include <string_view>

#include "oi/checksum.hpp"
#include "oi/dialect.hpp"
#include "oi/extensions.hpp"
#include "oi/frame.hpp"
#include "oi/sensors.hpp"
#include "oi/text/create_2.hpp"
#include "oi/text/describe.hpp"
#include "oi/text_tail.hpp"
#include "oi/value_names.hpp"

namespace cargobay::oi {
namespace {

using Kind = Annotation::Kind;
using Bytes = std::span<const std::uint8_t>;

void write_bits(TextWriter& out, PacketId packet, std::int32_t value) {
  std::string_view before = "(";
  visit_bits(packet, value, [&](std::string_view name) {
    out.put(before);
    out.put(name);
    before = ", ";
  });
  out.put(before == "(" ? "(none)" : ")");
}

class StreamDescriber {
 public:
  StreamDescriber(Bytes bytes, const AnnotationSink& sink, const Dialect& dialect)
      : bytes_{bytes}, dialect_{dialect}, tell_{bytes, sink} {}

  Described stream() {
    while (at_ < bytes_.size()) {
      const Bytes rest = bytes_.subspan(at_);
      if (const std::size_t length = whole_frame(rest); length != 0) {
        frame(rest.first(length));
        aligned_ = true;
      } else if (const std::size_t foreign = foreign_frame(rest); foreign != 0) {
        frame(rest.first(foreign));
        aligned_ = true;
      } else if (is_firmware_date(rest)) {
        firmware_date(rest);
      } else if (const std::size_t needed = needed_for_frame(rest); needed != 0) {
        return cut_short(needed);
      } else {
        aligned_ = false;
        between_frames();
      }
    }
    return tell_.described();
  }

  Described reply(std::span<const PacketId> packets) {
    std::size_t all = 0;
    for (const PacketId id : packets) all += dialect_.packet(id).size;
    for (const PacketId id : packets) {
      if (bytes_.size() - at_ >= dialect_.packet(id).size) {
        values(dialect_.packet(id));
      } else {
        part_of_packet(dialect_.packet(id));
      }
    }
    if (bytes_.size() < all) tell_.tell_missing(all - bytes_.size());
    if (at_ < bytes_.size()) {
      tell_.words().put("more than the reply");
      tell_.tell(Kind::stray, at_, bytes_.size() - at_, false);
    }
    return tell_.described();
  }

 private:
  // Length of the frame that these bytes begin with; 0 if there is none. A frame with a wrong
  // checksum counts unless one with a right checksum begins inside it.
  std::size_t whole_frame(Bytes bytes) const {
    const std::size_t length = well_formed(bytes);
    if (length == 0 || checksum_matches(bytes.first(length), Checksum::automatic)) return length;
    for (std::size_t begin = 1; begin < length; ++begin) {
      const Bytes inside = bytes.subspan(begin);
      const std::size_t other = well_formed(inside);
      if (other != 0 && checksum_matches(inside.first(other), Checksum::automatic)) return 0;
    }
    return length;
  }
  std::size_t well_formed(Bytes bytes) const {
    if (bytes.size() < kMinFrameBytes || bytes[0] != kFrameHeader) return 0;
    const std::size_t length = bytes[1] + kFrameOverhead;
    if (bytes.size() < length) return 0;
    return is_well_formed(bytes.first(length), dialect_.item_sizes) ? length : 0;
  }

  // Bytes that the id claims in a frame, itself included, of this robot or of the Create 2.
  std::size_t item_size(std::uint8_t id) const {
    const create_2::Packet* const other = create_2::find_packet(id);
    if (dialect_.item_sizes[id] != 0 || other == nullptr) return dialect_.item_sizes[id];
    return 1U + other->size;
  }
  // Length of the frame of another robot that these bytes begin with; 0 if there is none. Its
  // checksum is right and its packets fill it. Where a frame must begin one of the two is enough:
  // one in 128 wrong places has a right checksum.
  std::size_t foreign_frame(Bytes bytes) const {
    if (bytes.size() < kMinFrameBytes || bytes[0] != kFrameHeader) return 0;
    const std::size_t length = bytes[1] + kFrameOverhead;
    if (length < kMinFrameBytes || bytes.size() < length) return 0;
    const bool sum = checksum_matches(bytes.first(length), Checksum::automatic);
    std::size_t at = 2;
    while (at + 1 < length) {
      const std::size_t size = item_size(bytes[at]);
      if (size == 0) return sum && aligned_ ? length : 0;
      at += size;
    }
    return at + 1 == length && (sum || aligned_) ? length : 0;
  }

  bool is_firmware_date(Bytes bytes) const {
    return dialect_.has_undocumented_opcodes && bytes.size() >= kFirmwareDateBytes &&
           parse_firmware_date(bytes.first(kFirmwareDateBytes)).has_value();
  }
  void firmware_date(Bytes bytes) {
    const FirmwareDate date = *parse_firmware_date(bytes.first(kFirmwareDateBytes));
    TextWriter& out = tell_.words();
    out.put("answer to opcode 8: firmware of ");
    write_date(out, date);
    tell_.tell(Kind::value, at_, kFirmwareDateBytes);
    at_ += kFirmwareDateBytes;
  }

  // How many bytes are missing if these can be the beginning of a frame; 0 if they cannot, or if a
  // whole frame is inside. A frame of the Create 2 only where a frame must begin.
  std::size_t needed_for_frame(Bytes bytes) const {
    if (bytes[0] != kFrameHeader) return 0;
    if (bytes.size() == 1) return kMinFrameBytes - 1;
    const std::size_t length = bytes[1] + kFrameOverhead;
    if (length < kMinFrameBytes || bytes.size() >= length) return 0;
    for (std::size_t at = 2; at + 1 < length && at < bytes.size();) {
      const std::size_t size = aligned_ ? item_size(bytes[at]) : dialect_.item_sizes[bytes[at]];
      if (size == 0 || at + size + 1 > length) return 0;
      at += size;
    }
    for (std::size_t begin = 1; begin < bytes.size(); ++begin) {
      if (well_formed(bytes.subspan(begin)) != 0) return 0;
    }
    return length - bytes.size();
  }

  void header_and_length() {
    tell_.words().put("header of a stream frame (OI p. 14)");
    tell_.tell(Kind::header, at_++, 1);
    if (at_ == bytes_.size()) return;
    TextWriter& out = tell_.words();
    out.put_number(bytes_[at_]);
    out.put(" bytes up to the checksum");
    tell_.tell(Kind::length, at_++, 1);
  }

  void packet_id() {
    const PacketInfo& info = *dialect_.find_packet(bytes_[at_]);
    TextWriter& out = tell_.words();
    out.put("packet ");
    out.put_number(info.id);
    out.put(" ");
    out.put(info.name);
    tell_.tell(Kind::packet, at_++, 1);
  }

  // The packet is not this robot's; `end` is that of the frame's packets, or of the bytes.
  void foreign_packet(std::size_t end) {
    TextWriter& out = tell_.words();
    const create_2::Packet* const other = create_2::find_packet(bytes_[at_]);
    out.put("packet ");
    out.put_number(bytes_[at_]);
    if (other == nullptr) {
      out.put(" of neither this robot nor the Create 2: where it ends is not known");
    } else {
      out.put(" ");
      out.put(other->name);
      out.put(" of the Create 2 or a Roomba; this robot has none");
    }
    tell_.tell(Kind::packet, at_++, 1, false);
    const std::size_t there = end - at_;
    const std::size_t size = other == nullptr ? there : std::min<std::size_t>(other->size, there);
    if (size == 0) return;
    TextWriter& value = tell_.words();
    if (other != nullptr && size < other->size) {
      value.put("part of its data");
    } else if (size <= 2) {
      value.put_number(size == 1 ? bytes_[at_] : bytes_[at_] * 256 + bytes_[at_ + 1]);
    } else {
      value.put_number(static_cast<std::int64_t>(size));
      value.put(" bytes of data");
    }
    tell_.tell(Kind::value, at_, size);
    at_ += size;
  }

  void frame(Bytes frame) {
    const std::size_t checksum_at = at_ + frame.size() - 1;
    header_and_length();
    while (at_ < checksum_at) {
      if (dialect_.find_packet(bytes_[at_]) == nullptr) {
        foreign_packet(checksum_at);
        continue;
      }
      const PacketInfo& info = *dialect_.find_packet(bytes_[at_]);
      packet_id();
      values(info);
    }
    checksum(frame);
  }

  void checksum(Bytes frame) {
    TextWriter& out = tell_.words();
    const bool including = checksum_matches(frame, Checksum::including_header);
    const bool excluding = checksum_matches(frame, Checksum::excluding_header);
    if (including) {
      out.put("checksum, right with the header counted, as robots send it");
    } else if (excluding) {
      out.put("checksum, right without the header, as the manual has it");
    } else {
      const Bytes summed = frame.first(frame.size() - 1);
      out.put("wrong checksum: ");
      out.put_hex(checksum_of(summed, Checksum::including_header));
      out.put(" would be right with the header counted, ");
      out.put_hex(checksum_of(summed, Checksum::excluding_header));
      out.put(" without");
    }
    tell_.tell(Kind::checksum, at_++, 1, including || excluding);
  }

  // All bytes of the packet are there.
  void values(const PacketInfo& info) {
    for (std::uint8_t id = info.first; id <= info.last; ++id) {
      const PacketInfo& single = *dialect_.find_packet(id);
      const std::int32_t value = detail::read_value(single, bytes_.subspan(at_));
      TextWriter& out = tell_.words();
      out.put(single.key);
      out.put(" ");
      write_sensor_value(out, PacketId{id}, value);
      if (value < single.min || value > single.max) {
        out.put(", outside the manual's ");
        out.put_number(single.min);
        out.put(" to ");
        out.put_number(single.max);
      }
      tell_.tell(Kind::value, at_, single.size);  // a robot may send this, and it is delivered
      at_ += single.size;
    }
  }

  // As much of the packet as is there.
  void part_of_packet(const PacketInfo& info) {
    for (std::uint8_t id = info.first; id <= info.last && at_ < bytes_.size(); ++id) {
      const PacketInfo& single = *dialect_.find_packet(id);
      if (bytes_.size() - at_ >= single.size) {
        values(single);
        continue;
      }
      tell_.words().put(single.key);
      tell_.tell(Kind::value, at_, bytes_.size() - at_);
      at_ = bytes_.size();
    }
  }

  Described cut_short(std::size_t needed) {
    header_and_length();
    while (at_ < bytes_.size()) {
      if (dialect_.find_packet(bytes_[at_]) == nullptr) {
        foreign_packet(bytes_.size());
        continue;
      }
      const PacketInfo& info = *dialect_.find_packet(bytes_[at_]);
      packet_id();
      if (bytes_.size() - at_ >= info.size) {
        values(info);
      } else {
        part_of_packet(info);
      }
    }
    tell_.tell_missing(needed);
    return tell_.described();
  }

  // Text, a line at a time, or a run of anything else up to the next text or frame.
  void between_frames() {
    const std::size_t begin = at_;
    if (const std::size_t length = text_length(); length != 0) {
      write_printed(tell_.words(), bytes_.subspan(begin, length));
      at_ += length;
      return tell_.tell(Kind::printed, begin, length);
    }
    do {
      ++at_;
    } while (at_ < bytes_.size() && text_length() == 0 && !frame_begins());
    tell_.words().put("outside any frame");
    tell_.tell(Kind::stray, begin, at_ - begin, false);
  }
  // Length of the line of text that begins here; 0 if it is too short to be meant as text.
  std::size_t text_length() const {
    constexpr std::size_t kLeast = 4;
    constexpr std::size_t kMost = 100;
    const Bytes rest = bytes_.subspan(at_);
    std::size_t length = 0;
    while (length < rest.size() && length < kMost && is_text(rest[length])) {
      const bool line_ended = length > 0 && rest[length - 1] == '\n';
      if (line_ended && rest[length] != '\n' && rest[length] != '\r') break;
      ++length;
    }
    return length < kLeast ? 0 : length;
  }
  bool frame_begins() const {
    const Bytes rest = bytes_.subspan(at_);
    return is_firmware_date(rest) ||
           (rest[0] == kFrameHeader &&
            (whole_frame(rest) != 0 || foreign_frame(rest) != 0 || needed_for_frame(rest) != 0));
  }
  static void write_printed(TextWriter& out, Bytes text) {
    out.put("text '");
    for (const std::uint8_t byte : text) {
      const char c = static_cast<char>(byte);
      out.put(c == '\r' ? "\\r" : c == '\n' ? "\\n" : std::string_view{&c, 1});
    }
    out.put("'");
  }

  Bytes bytes_;
  const Dialect& dialect_;
  Annotator tell_;
  std::size_t at_ = 0;
  bool aligned_ = true;  // at the beginning, or after a frame
};

}  // namespace

void write_sensor_value(TextWriter& out, PacketId packet, std::int32_t value) {
  out.put_number(value);
  const std::string_view code = code_name(packet, value);
  if (!code.empty()) {
    out.put(" (");
    out.put(code);
    return out.put(")");
  }
  if (is_bit_set(packet)) {
    out.put(" ");
    return write_bits(out, packet, value);
  }
  const std::string_view unit = symbol(kCreateWithExtensions.packet(packet).unit);
  if (unit.empty()) return;
  out.put(" ");
  out.put(unit);
}

void write_date(TextWriter& out, const FirmwareDate& date) {
  const auto two = [&out](std::string_view before, std::uint8_t number) {
    out.put(before);
    if (number < 10) out.put("0");
    out.put_number(number);
  };
  two("20", date.year);
  two("-", date.month);
  two("-", date.day);
  two(" ", date.hour);
  two(":", date.minute);
}

Described describe_stream(std::span<const std::uint8_t> bytes, AnnotationSink sink,
                          const Dialect& dialect) {
  return StreamDescriber{bytes, sink, dialect}.stream();
}

Described describe_reply(std::span<const PacketId> packets, std::span<const std::uint8_t> bytes,
                         AnnotationSink sink, const Dialect& dialect) {
  return StreamDescriber{bytes, sink, dialect}.reply(packets);
}

}  // namespace cargobay::oi
