// What is typed on the terminal, byte by byte, and what a feed says meanwhile.
#pragma once

#include <functional>
#include <string>

#include "hal/cli/attached/feed_news.hpp"
#include "hal/feed/feed_reader.hpp"
#include "hal/feed/message/messages.hpp"
#include "hal/result.hpp"
#include "rt/clock.hpp"

namespace cargobay::cli {

// Whether standard input is a terminal from which keys can come.
bool keys_can_come();

// The bytes typed so far, without waiting; empty if nothing was, or standard input is not a
// terminal of this job. A Screen has the terminal give each key at once.
std::string typed();

// Waits until something is typed, the feed says something, `other` (a descriptor, or -1) has
// input, or that time comes.
void wait_for_input(const hal::FeedReader& reader, int other, rt::TimePoint until);

// Takes what the feed has said so far, and calls `see`, unless it is empty, with the type of each
// message. Fails when the feed has ended, or says that the robot's program has.
hal::Result<void> take_news(hal::FeedReader& reader, FeedNews& news,
                            const std::function<void(hal::FeedType)>& see);

}  // namespace cargobay::cli
