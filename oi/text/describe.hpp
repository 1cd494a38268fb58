// What bytes of the Open Interface mean, one by one, in words. For people: a tool, a log, a failing
// test. No heap; each description is handed over piece by piece.
#pragma once

#include <cstdint>
#include <span>

#include "oi/dialect.hpp"
#include "oi/packet_table.hpp"
#include "oi/text/annotation.hpp"
#include "oi/text/text_writer.hpp"

namespace cargobay::oi {

// Bytes that the host sends: opcode, arguments in wire order, and after each command its text form.
// Bytes in a script are annotated too, with `in_script`. An opcode of the Create 2 is named as
// such. `dialect` decides here and below whether the extensions are part of the robot.
Described describe_commands(std::span<const std::uint8_t> bytes, AnnotationSink sink,
                            const Dialect& dialect = kCreate);

// Bytes that the robot sends unasked: stream frames of either checksum, and the text it prints.
// Replies have no frame around them: here they are stray bytes. A frame with a right checksum but
// packets that this robot has not is described as that, by those of the Create 2.
Described describe_stream(std::span<const std::uint8_t> bytes, AnnotationSink sink,
                          const Dialect& dialect = kCreate);

// The reply to Sensors, or Query List, for these packets of the dialect.
Described describe_reply(std::span<const PacketId> packets, std::span<const std::uint8_t> bytes,
                         AnnotationSink sink, const Dialect& dialect = kCreate);

// A single packet's value and its meaning: `16254 mV`, `2 (safe)`, `3 (bump_right, bump_left)`.
void write_sensor_value(TextWriter& out, PacketId packet, std::int32_t value);

// `2007-09-24 18:05`.
void write_date(TextWriter& out, const FirmwareDate& date);

}  // namespace cargobay::oi
