#include "rt/kernel_file.hpp"

#include <unistd.h>

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cargobay::rt {
namespace {

using testing::IsEmpty;
using testing::StartsWith;

TEST(KernelFileTest, IsReadWhole) {
  EXPECT_THAT(kernel_file("/proc/self/stat"), StartsWith(std::to_string(getpid()) + " ("));
  // More than one read, and its size is told as 0.
  EXPECT_THAT(kernel_file("/proc/self/smaps"), testing::HasSubstr("[vdso]"));
}

TEST(KernelFileTest, IsEmptyIfItCannotBeOpened) {
  EXPECT_THAT(kernel_file("/proc/self/none"), IsEmpty());
}

// As when a process ends between open() and read().
TEST(KernelFileTest, IsEmptyIfItOpensAndCannotBeRead) {
  EXPECT_THAT(kernel_file("/proc/self"), IsEmpty());      // EISDIR
  EXPECT_THAT(kernel_file("/proc/self/mem"), IsEmpty());  // EIO
}

}  // namespace
}  // namespace cargobay::rt
