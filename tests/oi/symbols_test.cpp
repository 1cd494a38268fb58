// The codec needs nothing from the machine: its objects have only these few undefined symbols.
#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <set>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace {

using testing::IsEmpty;
using testing::Not;

const std::string kLibrary = CARGOBAY_BINARY_DIR "/oi/libcargobay_oi.a";
const std::string kTestObjects = CARGOBAY_BINARY_DIR "/tests/CMakeFiles/test_oi.dir/oi/";

std::set<std::string> undefined_symbols(const std::string& object) {
  const auto close = [](std::FILE* pipe) { (void)::pclose(pipe); };
  const std::string command = "nm --undefined-only '" + object + "'";
  // NOLINTNEXTLINE(bugprone-command-processor): nm, with a path that CMake gave
  const std::unique_ptr<std::FILE, decltype(close)> pipe{::popen(command.c_str(), "r"), close};
  std::set<std::string> symbols;
  std::array<char, 4096> line{};
  while (pipe != nullptr && std::fgets(line.data(), line.size(), pipe.get()) != nullptr) {
    std::string text{line.data()};
    text.erase(text.find_last_not_of(" \n") + 1);
    const std::size_t last_space = text.rfind(' ');
    if (last_space != std::string::npos) symbols.insert(text.substr(last_space + 1));
  }
  return symbols;
}

// Memory functions, the abort of a failed assertion, our own symbols, and those of a sanitizer or
// the stack protector. Neither operator new nor malloc, no throw, no read or write.
bool is_harmless(std::string_view symbol) {
  static constexpr std::array<std::string_view, 12> kNames{
      "memchr",           "memcmp",        "memcpy",        "memmove",
      "memset",           "bcmp",          "strlen",        "abort",
      "__stack_chk_fail", "__assert_fail", "__popcountdi2", "_GLOBAL_OFFSET_TABLE_"};
  static constexpr std::array<std::string_view, 10> kPrefixes{
      "_ZN8cargobay2oi", "_ZNK8cargobay2oi", "__asan_",          "__ubsan_", "__tsan_",
      "__rtsan_",        "__sancov_",        "__sanitizer_cov_", "__start_", "__stop_"};
  return std::ranges::find(kNames, symbol) != kNames.end() ||
         std::ranges::any_of(kPrefixes, [&](auto prefix) { return symbol.starts_with(prefix); });
}

// The tests are compiled with exceptions, so `noexcept` has a cost, and include a header of gtest
// that includes <iostream>.
bool is_of_the_tests(std::string_view symbol) {
  static constexpr std::array<std::string_view, 9> kNames{"_ZSt21ios_base_library_initv",
                                                          "_ZNSt8ios_base4InitC1Ev",
                                                          "_ZNSt8ios_base4InitD1Ev",
                                                          "__cxa_atexit",
                                                          "__dso_handle",
                                                          "__gxx_personality_v0",
                                                          "_ZSt9terminatev",
                                                          "__cxa_begin_catch",
                                                          "_Unwind_Resume"};
  return std::ranges::find(kNames, symbol) != kNames.end();
}

TEST(OiSymbols, LibraryNeedsNoHeapNoExceptionsAndNoInputOrOutput) {
  const auto symbols = undefined_symbols(kLibrary);
  ASSERT_THAT(symbols, Not(IsEmpty()));
  for (const std::string& symbol : symbols) EXPECT_TRUE(is_harmless(symbol)) << symbol;
}

TEST(OiSymbols, HeadersNeedNoHeapNoExceptionsAndNoInputOrOutput) {
  const auto symbols = undefined_symbols(kTestObjects + "used_headers.cpp.o");
  ASSERT_THAT(symbols, Not(IsEmpty()));
  for (const std::string& symbol : symbols) {
    EXPECT_TRUE(is_harmless(symbol) || is_of_the_tests(symbol)) << symbol;
  }
}

// Proves that the check sees such things: this test needs heap, output and exceptions.
TEST(OiSymbols, OfThisTestAreNotHarmless) {
  const auto symbols = undefined_symbols(kTestObjects + "symbols_test.cpp.o");
  for (const char* symbol : {"_Znwm", "popen", "__gxx_personality_v0"}) {
    EXPECT_TRUE(symbols.contains(symbol)) << symbol;
    EXPECT_FALSE(is_harmless(symbol)) << symbol;
  }
}

}  // namespace
