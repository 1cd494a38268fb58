// JSON schemas of the feed's messages, and of those of Foxglove's that only the server sends.
#pragma once

#include <string>

#include "hal/feed/message/messages.hpp"

namespace cargobay::web {

// Of the feed's messages of that type (docs/feed.md). Permits more members than it names.
std::string feed_schema(hal::FeedType type);

// foxglove.SceneUpdate, as far as drawn.hpp makes it.
std::string scene_update_schema();

}  // namespace cargobay::web
