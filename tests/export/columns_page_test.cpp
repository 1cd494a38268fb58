// docs/recording.md lists the columns as their tables have them.
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "hal/columns/records.hpp"

namespace cargobay::hal {
namespace {

constexpr const char* kPage = CARGOBAY_SOURCE_DIR "/docs/recording.md";

std::string contents_of(const char* path) {
  std::ostringstream text;
  text << std::ifstream{path}.rdbuf();
  return text.str();
}

// The page with its rows of each topic replaced by those of the table.
std::string with_columns(std::string page) {
  for (std::size_t i = 0; i < kTopics; ++i) {
    const TopicInfo& topic = info(static_cast<Topic>(i));
    const std::string head = "### Columns of " + std::string{topic.name} + "\n\n" +
                             "| column | unit | meaning |\n|---|---|---|\n";
    const std::size_t at = page.find(head);
    EXPECT_NE(at, std::string::npos) << topic.name;
    if (at == std::string::npos) return page;
    const std::size_t begin = at + head.size();
    std::size_t end = begin;
    while (page.compare(end, 1, "|") == 0) end = page.find('\n', end) + 1;
    page.replace(begin, end - begin, markdown_rows(topic));
  }
  return page;
}

TEST(ColumnsPage, ListsThem) {
  const std::string page = contents_of(kPage);
  const std::string wanted = with_columns(page);
  // NOLINTNEXTLINE(concurrency-mt-unsafe): one thread
  if (std::getenv("CARGOBAY_WRITE_DOCS") != nullptr) {
    std::ofstream{kPage} << wanted;
    return;
  }
  EXPECT_TRUE(page == wanted) << "write it: CARGOBAY_WRITE_DOCS=1 test_export "
                                 "--gtest_filter='ColumnsPage.*'";
}

}  // namespace
}  // namespace cargobay::hal
