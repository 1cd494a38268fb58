// Who steers.
#include "hal/feed/lease.hpp"

#include <chrono>
#include <cstdint>

#include <gtest/gtest.h>

namespace cargobay::hal {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr rt::TimePoint kNow{seconds{100}};
constexpr Lease::Client kAnn = 1;
constexpr Lease::Client kBob = 2;

TEST(Lease, GoesToOneAtATime) {
  Lease lease{seconds{3}};
  EXPECT_TRUE(lease.hold(kAnn, "ann", false, kNow));
  EXPECT_FALSE(lease.hold(kBob, "bob", false, kNow));
  EXPECT_EQ(lease.name(), "ann");
  EXPECT_TRUE(lease.holds(kAnn));
  EXPECT_FALSE(lease.holds(kBob));
}

TEST(Lease, IsTakenOnlyByWhomSaysSo) {
  Lease lease{seconds{3}};
  EXPECT_TRUE(lease.hold(kAnn, "ann", false, kNow));
  EXPECT_TRUE(lease.hold(kBob, "bob", true, kNow));
  EXPECT_EQ(lease.name(), "bob");
  EXPECT_FALSE(lease.release(kAnn)) << "it has been taken from her";
  EXPECT_TRUE(lease.holds(kBob));
}

TEST(Lease, LapsesWithoutASignOfItsHolder) {
  Lease lease{seconds{3}};
  EXPECT_TRUE(lease.hold(kAnn, "ann", false, kNow));
  EXPECT_FALSE(lease.expire(kNow + milliseconds{2999}));
  lease.renew(kAnn, kNow + seconds{2});
  lease.renew(kBob, kNow + seconds{4});  // not the holder's
  EXPECT_EQ(lease.until(), kNow + seconds{5});
  EXPECT_FALSE(lease.expire(kNow + seconds{4}));
  EXPECT_TRUE(lease.expire(kNow + seconds{5}));
  EXPECT_FALSE(lease.name());
  EXPECT_FALSE(lease.expire(kNow + seconds{6})) << "once";
}

TEST(Lease, IsRevokedForAll) {
  Lease lease{seconds{3}};
  EXPECT_FALSE(lease.revoke());
  EXPECT_TRUE(lease.hold(kAnn, "ann", false, kNow));
  EXPECT_TRUE(lease.revoke());
  EXPECT_FALSE(lease.holds(kAnn));
  EXPECT_FALSE(lease.until());
}

TEST(Lease, HasANumberByWhichHoldersOfOneNameDiffer) {
  Lease lease{seconds{3}};
  EXPECT_EQ(lease.number(), 0U);
  EXPECT_TRUE(lease.hold(kAnn, "page", false, kNow));
  const std::uint64_t of_ann = lease.number();
  EXPECT_NE(of_ann, 0U);
  EXPECT_TRUE(lease.hold(kAnn, "page", false, kNow + seconds{1}));
  EXPECT_EQ(lease.number(), of_ann) << "asking for it again is no other lease";
  EXPECT_FALSE(lease.hold(kBob, "page", false, kNow));
  EXPECT_EQ(lease.number(), of_ann);
  EXPECT_TRUE(lease.hold(kBob, "page", true, kNow));
  EXPECT_GT(lease.number(), of_ann);
  const std::uint64_t of_bob = lease.number();
  EXPECT_TRUE(lease.revoke());
  EXPECT_EQ(lease.number(), 0U);
  EXPECT_TRUE(lease.hold(kBob, "page", false, kNow));
  EXPECT_GT(lease.number(), of_bob) << "there was a time without a holder";
  const std::uint64_t again = lease.number();
  EXPECT_TRUE(lease.hold(kBob, "bob", false, kNow));
  EXPECT_GT(lease.number(), again) << "the name has changed";
}

}  // namespace
}  // namespace cargobay::hal
