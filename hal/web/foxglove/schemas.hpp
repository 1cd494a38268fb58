// JSON schemas of the feed's messages, and of those of Foxglove's that only the server sends.
#pragma once

#include <string>
#include <string_view>

namespace cargobay::web {

// Of the feed's messages of that type (docs/feed.md). Permits more members than it names.
std::string feed_schema(std::string_view type);

// foxglove.SceneUpdate, as far as drawn.hpp makes it.
std::string scene_update_schema();

}  // namespace cargobay::web
