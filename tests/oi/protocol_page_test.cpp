#include "tests/oi/protocol_page.hpp"

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oi/command_table.hpp"
#include "oi/packet_table.hpp"

namespace cargobay::oi {
namespace {

using testing::HasSubstr;

constexpr const char* kPath = CARGOBAY_SOURCE_DIR "/docs/protocol.md";

TEST(ProtocolPage, IsNotStale) {
  // NOLINTNEXTLINE(concurrency-mt-unsafe): one thread
  if (std::getenv("CARGOBAY_WRITE_DOCS") != nullptr) std::ofstream{kPath} << protocol_page();
  std::ostringstream committed;
  committed << std::ifstream{kPath}.rdbuf();
  EXPECT_EQ(committed.str(), protocol_page())
      << "docs/protocol.md is stale: CARGOBAY_WRITE_DOCS=1 makes this test write it";
}

TEST(ProtocolPage, HasEveryCommandAndPacket) {
  const std::string page = protocol_page();
  for (const CommandInfo& info : kCommands) {
    EXPECT_THAT(page, HasSubstr("| " + std::to_string(info.opcode) + " | " +
                                std::string{info.name} + " | `"));
  }
  for (const PacketInfo& info : kPackets) {
    if (info.is_group()) continue;
    EXPECT_THAT(
        page, HasSubstr("| " + std::to_string(info.id) + " | " + std::string{info.name} + " | `"));
  }
}

}  // namespace
}  // namespace cargobay::oi
