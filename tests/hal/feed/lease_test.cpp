// Who steers.
#include "hal/feed/lease.hpp"

#include <chrono>

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

}  // namespace
}  // namespace cargobay::hal
