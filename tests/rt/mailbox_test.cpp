#include "rt/mailbox.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <thread>

#include <gtest/gtest.h>

#include "tests/rt/stress.hpp"

namespace cargobay::rt {
namespace {

// A value that shows whether it is whole: all its words are equal.
struct Whole {
  std::array<std::uint64_t, 64> words{};

  static Whole of(std::uint64_t word) {
    Whole value;
    value.words.fill(word);
    return value;
  }
  bool is_torn() const {
    return std::any_of(words.begin(), words.end(),
                       [this](std::uint64_t word) { return word != words.front(); });
  }
};

TEST(Mailbox, IsEmptyUntilSomethingIsPut) {
  Mailbox<int> mailbox;
  EXPECT_FALSE(mailbox.get().has_value());
  mailbox.put(0);
  EXPECT_EQ(mailbox.get(), 0);
}

TEST(Mailbox, HoldsTheLatest) {
  Mailbox<int> mailbox;
  for (int i = 1; i <= 1000; ++i) {
    mailbox.put(i);
    EXPECT_EQ(mailbox.get(), i);
    EXPECT_EQ(mailbox.get(), i) << "reading takes nothing away";
  }
}

template <std::size_t kBytes>
struct Bytes {
  std::array<std::uint8_t, kBytes> bytes{};
  friend bool operator==(const Bytes&, const Bytes&) = default;
};

template <std::size_t kBytes>
void expect_round_trip() {
  Mailbox<Bytes<kBytes>> mailbox;
  Bytes<kBytes> value;
  for (std::size_t i = 0; i < kBytes; ++i) value.bytes[i] = static_cast<std::uint8_t>(i + 1);
  mailbox.put(value);
  EXPECT_EQ(mailbox.get(), value) << kBytes;
}

TEST(Mailbox, TakesValuesOfAnySize) {
  expect_round_trip<1>();
  expect_round_trip<7>();
  expect_round_trip<8>();
  expect_round_trip<9>();
  expect_round_trip<63>();
  expect_round_trip<1000>();
}

// Does a reader ever see half of one value and half of another, or an older one than before?
template <typename Box>
bool is_caught(Box& box) {
  std::uint64_t written = 0;
  std::uint64_t newest = 0;
  std::uint64_t changes = 0;
  bool caught = false;
  // If other load starves them, the two may hardly meet in one go.
  for (int i = 0; i < test::kMostGoes && !caught && changes < test::kLeast; ++i) {
    test::contend([&] { box.put(Whole::of(++written)); },
                  [&] {
                    const auto value = box.get();
                    if (!value.has_value()) return false;
                    caught = value->is_torn() || value->words.front() < newest;
                    if (value->words.front() != newest) ++changes;
                    newest = value->words.front();
                    return caught || changes >= test::kEnough;
                  });
  }
  EXPECT_TRUE(caught || changes >= test::kLeast) << "only " << changes << " values seen";
  return caught;
}

TEST(Mailbox, IsNeverReadTorn) {
  Mailbox<Whole> mailbox;
  EXPECT_FALSE(is_caught(mailbox));
}

TEST(Mailbox, ServesSeveralReaders) {
  Mailbox<Whole> mailbox;
  std::atomic<bool> torn{false};
  std::atomic<bool> over{false};
  std::thread other{[&] {
    while (!over.load(std::memory_order_relaxed)) {
      const auto value = mailbox.get();
      if (value.has_value() && value->is_torn()) torn.store(true, std::memory_order_relaxed);
    }
  }};
  EXPECT_FALSE(is_caught(mailbox));
  over.store(true, std::memory_order_relaxed);
  other.join();
  EXPECT_FALSE(torn.load(std::memory_order_relaxed));
}

// Wrong on purpose: the sequence is never odd, so a reader in the middle of a write is not warned.
class MailboxWithoutOddStep {
 public:
  void put(const Whole& value) {
    const std::uint64_t sequence = sequence_.load(std::memory_order_relaxed);
    for (std::size_t i = 0; i < words_.size(); ++i) {
      words_[i].store(value.words[i], std::memory_order_release);
      if (i == words_.size() / 2) test::falter();
    }
    sequence_.store(sequence + 2, std::memory_order_release);
  }
  std::optional<Whole> get() const {
    Whole value;
    for (;;) {
      const std::uint64_t before = sequence_.load(std::memory_order_acquire);
      if (before == 0) return std::nullopt;
      for (std::size_t i = 0; i < words_.size(); ++i) {
        value.words[i] = words_[i].load(std::memory_order_acquire);
      }
      if (sequence_.load(std::memory_order_relaxed) == before) return value;
    }
  }

 private:
  std::atomic<std::uint64_t> sequence_{0};
  std::array<std::atomic<std::uint64_t>, 64> words_{};
};

TEST(Mailbox, WouldBeCaughtWithoutItsOddStep) {
  MailboxWithoutOddStep broken;
  EXPECT_TRUE(is_caught(broken));
}

// Wrong on purpose: the words alone.
class MailboxWithoutSequence {
 public:
  void put(const Whole& value) {
    for (std::size_t i = 0; i < words_.size(); ++i) {
      words_[i].store(value.words[i], std::memory_order_release);
      if (i == words_.size() / 2) test::falter();
    }
  }
  std::optional<Whole> get() const {
    Whole value;
    for (std::size_t i = 0; i < words_.size(); ++i) {
      value.words[i] = words_[i].load(std::memory_order_acquire);
    }
    return value;
  }

 private:
  std::array<std::atomic<std::uint64_t>, 64> words_{};
};

TEST(Mailbox, WouldBeCaughtWithoutASequence) {
  MailboxWithoutSequence broken;
  EXPECT_TRUE(is_caught(broken));
}

}  // namespace
}  // namespace cargobay::rt
