// Writes MCAP, version 0 (https://mcap.dev/spec): schemas, channels, messages in chunks, and the
// index by which a reader finds its way in them. Chunks are not compressed. All checksums are
// there: of chunks, of the data and of the summary.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hal/export/record_sink.hpp"
#include "hal/result.hpp"

namespace cargobay::hal {

inline constexpr std::string_view kMcapMagic{"\x89MCAP0\r\n", 8};

// A file that was not finished can be read up to its last whole chunk. One thread. Memory: a chunk
// of about 256 KiB, and the index: about 200 bytes for each chunk.
class McapWriter {
 public:
  using Schema = std::uint16_t;
  using Channel = std::uint16_t;

  // `library`: what writes it, with its version.
  McapWriter(WriteBytes write, std::string_view library);

  // A JSON schema; `title` is the name that programs know it by.
  Schema add_schema(std::string_view title, std::string_view json_schema);
  // Messages of it are JSON objects.
  Channel add_channel(std::string_view topic, Schema schema);
  void metadata(std::string_view name, const std::map<std::string, std::string>& values);
  // `time_ns`: since 1970 UTC.
  void message(Channel channel, std::uint64_t time_ns, std::string_view json);
  // The index. The last call. Fails as the first write that failed.
  Result<void> finish();

  // What went wrong so far: nothing is written after it.
  const Result<void>& written() const { return written_; }

 private:
  struct Span {
    std::uint64_t first_ns = 0;
    std::uint64_t last_ns = 0;
    bool empty = true;
    void include(std::uint64_t time_ns);
  };
  struct ChannelState {
    std::uint64_t messages = 0;
    std::vector<std::pair<std::uint64_t, std::uint64_t>> index{};  // of the chunk: time, offset
  };

  void close_chunk();
  std::string statistics() const;
  void summary_group(std::string& out, std::uint8_t opcode, const std::string& records);
  // To the file, as part of its data section.
  void write_data(std::string_view bytes);
  void write(std::string_view bytes);

  WriteBytes write_;
  Result<void> written_{};
  std::uint64_t position_ = 0;  // in the file
  std::uint32_t data_crc_ = 0;
  std::string chunk_{};  // its records so far
  Span chunk_span_{};
  Span span_{};
  std::vector<ChannelState> channels_{};
  std::uint16_t schemas_ = 0;
  std::uint32_t chunks_ = 0;
  std::uint32_t metadata_ = 0;
  // Records of the summary, and of its groups where each is.
  std::string schema_records_{};
  std::string channel_records_{};
  std::string chunk_index_{};
  std::string metadata_index_{};
  std::string summary_offsets_{};
};

}  // namespace cargobay::hal
