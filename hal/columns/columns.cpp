#include "hal/columns/columns.hpp"

namespace cargobay::hal {

std::string markdown_rows(const TopicInfo& topic) {
  std::string out;
  for (const ColumnInfo* const column : topic.columns) {
    out += "| `" + column->path + "` | " + column->unit + " | " + column->meaning + " |\n";
  }
  return out;
}

}  // namespace cargobay::hal
