#include "hal/export/mcap_writer.hpp"

#include <algorithm>
#include <concepts>

#include "hal/recording/recording_format.hpp"

namespace cargobay::hal {
namespace {

constexpr std::size_t kChunkBytes = std::size_t{1} << 18U;

// The opcodes of records.
enum class Op : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics = 0x0B,
  metadata = 0x0C,
  metadata_index = 0x0D,
  summary_offset = 0x0E,
  data_end = 0x0F,
};

// The values of a record, one after the other: numbers little endian, texts after their length.
template <std::unsigned_integral Number>
void put(std::string& out, Number number) {
  for (std::size_t i = 0; i < sizeof number; ++i)
    out += static_cast<char>(static_cast<std::uint8_t>(std::uint64_t{number} >> (8 * i)));
}
void put(std::string& out, std::string_view text) {
  put(out, static_cast<std::uint32_t>(text.size()));
  out += text;
}
// A map or an array: its size in bytes, then what is in it.
void put_list(std::string& out, std::string_view entries) { put(out, entries); }

std::string record(Op op, std::string_view content) {
  std::string out;
  out.reserve(9 + content.size());
  put(out, static_cast<std::uint8_t>(op));
  put(out, std::uint64_t{content.size()});
  return out += content;
}

template <typename... Values>
std::string record_of(Op op, const Values&... values) {
  std::string content;
  (put(content, values), ...);
  return record(op, content);
}

std::uint32_t crc(std::string_view bytes, std::uint32_t before = 0) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): characters as bytes
  return crc32({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, before);
}

}  // namespace

void McapWriter::Span::include(std::uint64_t time_ns) {
  first_ns = empty ? time_ns : std::min(first_ns, time_ns);
  last_ns = empty ? time_ns : std::max(last_ns, time_ns);
  empty = false;
}

McapWriter::McapWriter(WriteBytes write, std::string_view library) : write_{std::move(write)} {
  write_data(kMcapMagic);
  write_data(record_of(Op::header, std::string_view{}, library));
}

McapWriter::Schema McapWriter::add_schema(std::string_view title, std::string_view json_schema) {
  const Schema id = ++schemas_;  // 0 means none
  const std::string schema =
      record_of(Op::schema, id, title, std::string_view{"jsonschema"}, json_schema);
  schema_records_ += schema;
  write_data(schema);
  return id;
}

McapWriter::Channel McapWriter::add_channel(std::string_view topic, Schema schema) {
  const auto id = static_cast<Channel>(channels_.size());
  channels_.emplace_back();
  const std::string channel = record_of(Op::channel, id, schema, topic, std::string_view{"json"},
                                        std::string_view{});  // no metadata
  channel_records_ += channel;
  write_data(channel);
  return id;
}

void McapWriter::metadata(std::string_view name, const std::map<std::string, std::string>& values) {
  std::string entries;
  for (const auto& [key, value] : values) {
    put(entries, key);
    put(entries, value);
  }
  std::string content;
  put(content, name);
  put_list(content, entries);
  const std::string metadata = record(Op::metadata, content);
  metadata_index_ += record_of(Op::metadata_index, position_, std::uint64_t{metadata.size()}, name);
  ++metadata_;
  write_data(metadata);
}

void McapWriter::message(Channel channel, std::uint64_t time_ns, std::string_view json) {
  ChannelState& state = channels_[channel];
  state.index.emplace_back(time_ns, chunk_.size());
  constexpr std::uint64_t kHead = 2 + 4 + 8 + 8;
  put(chunk_, static_cast<std::uint8_t>(Op::message));
  put(chunk_, kHead + json.size());
  put(chunk_, channel);
  put(chunk_, static_cast<std::uint32_t>(state.messages++));
  put(chunk_, time_ns);  // when it was noted, and when it was so
  put(chunk_, time_ns);
  chunk_ += json;
  chunk_span_.include(time_ns);
  if (chunk_.size() >= kChunkBytes) close_chunk();
}

void McapWriter::close_chunk() {
  if (chunk_.empty()) return;
  const std::string_view uncompressed;
  std::string head;
  put(head, chunk_span_.first_ns);
  put(head, chunk_span_.last_ns);
  put(head, std::uint64_t{chunk_.size()});
  put(head, crc(chunk_));
  put(head, uncompressed);
  put(head, std::uint64_t{chunk_.size()});
  const std::uint64_t chunk_begin = position_;
  std::string opening;
  put(opening, static_cast<std::uint8_t>(Op::chunk));
  put(opening, std::uint64_t{head.size() + chunk_.size()});
  write_data(opening + head);
  write_data(chunk_);
  const std::uint64_t chunk_end = position_;

  std::string offsets;  // of the message indexes in the file
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (channels_[i].index.empty()) continue;
    const auto id = static_cast<Channel>(i);
    put(offsets, id);
    put(offsets, position_);
    std::string entries;
    for (const auto& [time_ns, offset] : channels_[i].index) {
      put(entries, time_ns);
      put(entries, offset);
    }
    channels_[i].index.clear();
    std::string content;
    put(content, id);
    put_list(content, entries);
    write_data(record(Op::message_index, content));
  }
  chunk_index_ +=
      record_of(Op::chunk_index, chunk_span_.first_ns, chunk_span_.last_ns, chunk_begin,
                chunk_end - chunk_begin, std::string_view{offsets}, position_ - chunk_end,
                uncompressed, std::uint64_t{chunk_.size()}, std::uint64_t{chunk_.size()});
  span_.include(chunk_span_.first_ns);
  span_.include(chunk_span_.last_ns);
  ++chunks_;
  chunk_.clear();
  chunk_span_ = {};
}

std::string McapWriter::statistics() const {
  std::uint64_t messages = 0;
  std::string counts;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    messages += channels_[i].messages;
    put(counts, static_cast<Channel>(i));
    put(counts, channels_[i].messages);
  }
  constexpr std::uint32_t kAttachments = 0;
  return record_of(Op::statistics, messages, schemas_, static_cast<std::uint32_t>(channels_.size()),
                   kAttachments, metadata_, chunks_, span_.first_ns, span_.last_ns,
                   std::string_view{counts});
}

void McapWriter::summary_group(std::string& out, std::uint8_t opcode, const std::string& records) {
  if (records.empty()) return;
  summary_offsets_ +=
      record_of(Op::summary_offset, opcode, position_ + out.size(), std::uint64_t{records.size()});
  out += records;
}

Result<void> McapWriter::finish() {
  close_chunk();
  write(record_of(Op::data_end, data_crc_));
  const std::uint64_t summary_begin = position_;
  std::string summary;
  summary_group(summary, static_cast<std::uint8_t>(Op::schema), schema_records_);
  summary_group(summary, static_cast<std::uint8_t>(Op::channel), channel_records_);
  summary_group(summary, static_cast<std::uint8_t>(Op::statistics), statistics());
  summary_group(summary, static_cast<std::uint8_t>(Op::chunk_index), chunk_index_);
  summary_group(summary, static_cast<std::uint8_t>(Op::metadata_index), metadata_index_);
  const std::uint64_t offsets_begin = summary_begin + summary.size();
  summary += summary_offsets_;
  // The checksum covers the footer too, up to itself.
  std::string footer = record_of(Op::footer, summary_begin, offsets_begin, std::uint32_t{0});
  footer.resize(footer.size() - sizeof(std::uint32_t));
  summary += footer;
  put(summary, crc(summary));
  write(summary += kMcapMagic);
  return written_;
}

void McapWriter::write_data(std::string_view bytes) {
  data_crc_ = crc(bytes, data_crc_);
  write(bytes);
}

void McapWriter::write(std::string_view bytes) {
  position_ += bytes.size();
  if (written_) written_ = write_(bytes);
}

}  // namespace cargobay::hal
